// What the programs of ./reproduce visibility share: scenes, view cells spread over them, and producers judged by what rays see.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "programs/measuring.h"
#include "visibility/cells/grid_cells.h"
#include "visibility/generators/city.h"
#include "visibility/generators/dense_city.h"
#include "visibility/generators/plant.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/producers/see.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/rays/ray_caster.h"

namespace vismat::bench {

/// Another object of triangles, each three of `corners`.
inline void add_object(Scene& scene, std::span<const glm::dvec3> corners,
                       std::span<const std::uint32_t> indices) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (const glm::dvec3& corner : corners) scene.vertices.emplace_back(corner);
  for (const std::uint32_t index : indices) scene.indices.push_back(first + index);
  scene.object_of_triangle.insert(scene.object_of_triangle.end(), indices.size() / 3, scene.object_count++);
}

/// A box round `centre` with its axes scaled and turned, closed and outward oriented.
inline void add_box(Scene& scene, const glm::dvec3& centre, const std::array<glm::dvec3, 3>& half_axes) {
  std::array<glm::dvec3, 8> corners;
  for (unsigned c = 0; c < 8; ++c) {
    corners[c] = centre;
    for (unsigned k = 0; k < 3; ++k) corners[c] += (c >> k & 1 ? 1. : -1.) * half_axes[k];
  }
  constexpr std::uint32_t indices[] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  add_object(scene, corners, indices);
}

inline glm::dvec3 in_unit_ball(Random& random) {
  glm::dvec3 p;
  do {
    p = {2 * random.fraction() - 1, 2 * random.fraction() - 1, 2 * random.fraction() - 1};
  } while (glm::dot(p, p) > 1 || glm::dot(p, p) < 1e-4);
  return p;
}

/// Boxes of side `side` at random places of [0, extent].
inline ViewCells scattered_cells(std::uint32_t count, float side, const glm::vec3& extent, Random random) {
  ViewCells cells;
  for (std::uint32_t i = 0; i < count; ++i) {
    Box box;
    for (int k = 0; k < 3; ++k) {
      box.low[k] = random.unit() * (extent[k] - side);
      box.high[k] = box.low[k] + side;
    }
    cells.boxes.push_back(box);
  }
  return cells;
}

/// Triangles about 20 m long in a cube of 100 m, each an object.
inline SceneFile make_soup(std::uint32_t triangles = 2000) {
  SceneFile file;
  Random random(5);
  constexpr std::uint32_t indices[] = {0, 1, 2};
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::dvec3 middle = 100. * glm::dvec3(random.fraction(), random.fraction(), random.fraction());
    std::array<glm::dvec3, 3> corners;
    for (glm::dvec3& corner : corners) corner = middle + 14. * in_unit_ball(random);
    add_object(file.scene, corners, indices);
  }
  file.cells = scattered_cells(1000, 1, {100, 100, 100}, Random(6));
  return file;
}

/// Boxes of 2 to 12 m that lean every way, on 200 x 200 m.
inline SceneFile make_tilted_boxes(std::uint32_t boxes = 1200) {
  SceneFile file;
  Random random(7);
  for (std::uint32_t i = 0; i < boxes; ++i) {
    const glm::dvec3 u = glm::normalize(in_unit_ball(random)),
                     v = glm::normalize(glm::cross(u, in_unit_ball(random))), w = glm::cross(u, v);
    const auto half = [&] { return 1 + 5 * random.fraction(); };
    const glm::dvec3 centre(200 * random.fraction(), 200 * random.fraction(), 12 * random.fraction());
    const double a = half(), b = half(), c = half();
    add_box(file.scene, centre, {a * u, b * v, c * w});
  }
  file.cells = scattered_cells(1000, 3, {200, 200, 12}, Random(8));
  return file;
}

/// By the name that stands in tables; a file (see read_any_scene) gets grid cells of 2 m.
inline SceneFile study_scene(const std::string& name) {
  if (name == "dense-city") return make_dense_city();
  if (name == "box-city") {
    CityOptions options;
    options.eye_low = 1, options.eye_high = 2.5f;
    return make_city(options);
  }
  if (name == "plant") {
    PlantOptions options;
    options.size = 3;
    return make_plant(options);
  }
  if (name == "soup") return make_soup();
  if (name == "tilted-boxes") return make_tilted_boxes();
  SceneFile file = read_any_scene(name).file;
  GridCellsOptions grid;
  grid.size = {2, 2, 2};
  if (file.cells.count() == 0) file.cells = make_grid_cells(file.scene, grid);
  return file;
}

/// "oa_koth1" of "pak1-maps.pk3:maps/oa_koth1.bsp".
inline std::string scene_name(const std::string& name) {
  return std::filesystem::path(name.substr(name.rfind(':') + 1)).stem();
}

inline ViewCells part_of(const ViewCells& cells, std::uint32_t first, std::uint32_t count) {
  ViewCells part;
  part.eye_low = cells.eye_low, part.eye_high = cells.eye_high;
  for (std::uint32_t i = first; i < std::min(first + count, cells.count()); ++i) {
    if (i < cells.prisms()) {
      part.corners.insert(part.corners.end(), cells.corners.begin() + 3 * i,
                          cells.corners.begin() + 3 * i + 3);
    } else {
      part.boxes.push_back(cells.boxes[i - cells.prisms()]);
    }
  }
  return part;
}

/// Cells that follow one another, `each` at a place, at places spread evenly over the numbering.
inline std::vector<ViewCells> places_of(const ViewCells& cells, std::uint32_t places, std::uint32_t each) {
  std::vector<ViewCells> found;
  for (std::uint32_t i = 0; i < places; ++i) {
    const std::uint64_t middle = (2 * std::uint64_t{i} + 1) * cells.count() / (2 * places);
    const auto first = static_cast<std::uint32_t>(middle - std::min<std::uint64_t>(middle, each / 2));
    found.push_back(part_of(cells, first, each));
  }
  return found;
}

/// The cells of all groups; they are either all boxes or all prisms.
inline ViewCells joined(std::span<const ViewCells> groups) {
  ViewCells all;
  for (const ViewCells& group : groups) {
    all.eye_low = group.eye_low, all.eye_high = group.eye_high;
    all.corners.insert(all.corners.end(), group.corners.begin(), group.corners.end());
    all.boxes.insert(all.boxes.end(), group.boxes.begin(), group.boxes.end());
  }
  return all;
}

using Objects = std::vector<std::uint32_t>;

/// A way to find what is visible, and what came of it, cell by cell.
struct Run {
  std::string producer, settings;
  bool tells_hidden = false, tells_seen = false;
  std::vector<Objects> not_hidden, seen;
  std::vector<double> ms, wall_ms;  // a cell, one number a place
  double preparing_ms = 0;          // all of it, once a scene

  std::string cells_line() const {
    const auto at = [](std::vector<double> values, double share) {
      std::sort(values.begin(), values.end());
      return values[static_cast<std::size_t>(std::round(share * static_cast<double>(values.size() - 1)))];
    };
    std::string line = csv_line(at(ms, .5), at(ms, 0), at(ms, 1), at(wall_ms, .5), preparing_ms);
    line.back() = ',';
    return line;
  }
};

/// Some view cells of a scene. Producers run on them one thread at a time; the reference is dense_reference() and all
/// that any producer saw.
class Study {
 public:
  Study(std::string name, const Scene& scene, std::vector<ViewCells> places)
      : name_(std::move(name)),
        scene_(scene),
        places_(std::move(places)),
        caster_(scene),
        rays_(scene, caster_) {}

  const Scene& scene() const { return scene_; }
  const AimedRays& rays() const { return rays_; }

  void run(const std::string& producer, const std::string& settings, bool tells_hidden, bool tells_seen,
           const std::function<Sight(const ViewCells&, Crew&)>& produce, double preparing_ms = 0) {
    Run run{producer, settings, tells_hidden, tells_seen, {}, {}, {}, {}, preparing_ms};
    ThreadCrew one(1);
    for (const ViewCells& cells : places_) {
      const double wall = wall_seconds(), busy = processor_seconds();
      const Sight sight = produce(cells, one);
      run.ms.push_back(1e3 * (processor_seconds() - busy) / cells.count());
      run.wall_ms.push_back(1e3 * (wall_seconds() - wall) / cells.count());
      const auto rows = [&](const VisibilityMatrix& matrix, std::vector<Objects>& lists) {
        for (std::uint32_t i = 0; i < cells.count(); ++i)
          lists.emplace_back(matrix.row(i).begin(), matrix.row(i).end());
      };
      if (tells_hidden) rows(sight.not_hidden, run.not_hidden);
      if (tells_seen) rows(sight.seen, run.seen);
    }
    std::fprintf(stderr, "%s: %s, %s: %.1f ms a cell\n", name_.c_str(), producer.c_str(), settings.c_str(),
                 std::accumulate(run.ms.begin(), run.ms.end(), 0.) / static_cast<double>(run.ms.size()));
    runs_.push_back(std::move(run));
  }

  static constexpr const char* header =
      "scene,triangles,objects,cells,producer,settings,ms_median,ms_least,ms_most,wall_ms,preparing_ms,not_"
      "hidden,"
      "seen,reference,over_estimation,found,undecided,wrongly_hidden\n";
  /// A line a run. `wrong` grows by how many objects a run hid that a ray reached.
  std::string lines(std::uint64_t& wrong) {
    const ViewCells all = joined(places_);
    std::vector<std::uint32_t> ids(all.count());
    std::iota(ids.begin(), ids.end(), 0);
    ThreadCrew crew;
    const VisibilityMatrix dense = dense_reference(rays_, all, ids, crew);
    std::vector<Objects> reference(ids.size());
    double known = 0;
    for (const std::uint32_t i : ids) {
      reference[i].assign(dense.row(i).begin(), dense.row(i).end());
      for (const Run& run : runs_) {
        if (!run.tells_seen) continue;
        Objects both;
        std::set_union(reference[i].begin(), reference[i].end(), run.seen[i].begin(), run.seen[i].end(),
                       std::back_inserter(both));
        reference[i] = std::move(both);
      }
      known += static_cast<double>(reference[i].size());
    }
    std::string csv;
    for (const Run& run : runs_) {
      double not_hidden = 0, seen = 0;
      std::uint64_t hidden_wrongly = 0;
      for (const std::uint32_t i : ids) {
        if (run.tells_seen) seen += static_cast<double>(run.seen[i].size());
        if (!run.tells_hidden) continue;
        not_hidden += static_cast<double>(run.not_hidden[i].size());
        Objects missing;
        std::set_difference(reference[i].begin(), reference[i].end(), run.not_hidden[i].begin(),
                            run.not_hidden[i].end(), std::back_inserter(missing));
        hidden_wrongly += missing.size();
      }
      wrong += hidden_wrongly;
      const auto cells = static_cast<double>(ids.size());
      const auto text = [](bool told, double value) { return told ? std::to_string(value) : std::string(); };
      std::string start = csv_line(name_, scene_.object_of_triangle.size(), scene_.object_count, ids.size(),
                                   run.producer, bench::quoted(run.settings));
      start.back() = ',';
      csv += start + run.cells_line() +
             csv_line(text(run.tells_hidden, not_hidden / cells), text(run.tells_seen, seen / cells),
                      known / cells, text(run.tells_hidden, not_hidden / known),
                      text(run.tells_seen, seen / known),
                      text(run.tells_hidden, (not_hidden - seen) / cells / scene_.object_count),
                      text(run.tells_hidden, static_cast<double>(hidden_wrongly)));
    }
    return csv;
  }

 private:
  std::string name_;
  const Scene& scene_;
  std::vector<ViewCells> places_;
  RayCaster caster_;
  AimedRays rays_;
  std::vector<Run> runs_;
};

}  // namespace vismat::bench
