#include "bench/visibility_study.h"

#include <algorithm>
#include <cstdio>
#include <glm/geometric.hpp>
#include <iterator>
#include <numeric>
#include <utility>

#include "programs/csv.h"
#include "programs/measuring.h"
#include "visibility/cells/grid_cells.h"
#include "visibility/generators/city.h"
#include "visibility/generators/dense_city.h"
#include "visibility/generators/plant.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::bench {
namespace {

using Objects = Run::Objects;

// Boxes of side `side` at random places of [0, extent].
ViewCells scattered_cells(std::uint32_t count, float side, const glm::vec3& extent, Random random) {
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

SceneFile make_soup() {
  SceneFile file;
  Random random(5);
  constexpr std::uint32_t triangles = 2000, indices[] = {0, 1, 2};
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::dvec3 middle = 100. * glm::dvec3(random.fraction(), random.fraction(), random.fraction());
    std::array<glm::dvec3, 3> corners;
    for (glm::dvec3& corner : corners) corner = middle + 14. * in_unit_ball(random);
    add_object(file.scene, corners, indices);
  }
  file.cells = scattered_cells(1000, 1, {100, 100, 100}, Random(6));
  return file;
}

SceneFile make_tilted_boxes() {
  SceneFile file;
  Random random(7);
  constexpr std::uint32_t boxes = 1200;
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

ViewCells part_of(const ViewCells& cells, std::uint32_t first, std::uint32_t count) {
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

// The cells of all groups; they are either all boxes or all prisms.
ViewCells joined(std::span<const ViewCells> groups) {
  ViewCells all;
  for (const ViewCells& group : groups) {
    all.eye_low = group.eye_low, all.eye_high = group.eye_high;
    all.corners.insert(all.corners.end(), group.corners.begin(), group.corners.end());
    all.boxes.insert(all.boxes.end(), group.boxes.begin(), group.boxes.end());
  }
  return all;
}

}  // namespace

void add_object(Scene& scene, std::span<const glm::dvec3> corners, std::span<const std::uint32_t> indices) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (const glm::dvec3& corner : corners) scene.vertices.emplace_back(corner);
  for (const std::uint32_t index : indices) scene.indices.push_back(first + index);
  scene.object_of_triangle.insert(scene.object_of_triangle.end(), indices.size() / 3, scene.object_count++);
}

void add_box(Scene& scene, const std::array<glm::dvec3, 8>& corners) {
  constexpr std::uint32_t indices[] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  add_object(scene, corners, indices);
}

void add_box(Scene& scene, const glm::dvec3& centre, const std::array<glm::dvec3, 3>& half_axes) {
  std::array<glm::dvec3, 8> corners;
  for (unsigned c = 0; c < 8; ++c) {
    corners[c] = centre;
    for (unsigned k = 0; k < 3; ++k) corners[c] += (c >> k & 1 ? 1. : -1.) * half_axes[k];
  }
  add_box(scene, corners);
}

glm::dvec3 in_unit_ball(Random& random) {
  glm::dvec3 p;
  do {
    p = {2 * random.fraction() - 1, 2 * random.fraction() - 1, 2 * random.fraction() - 1};
  } while (glm::dot(p, p) > 1 || glm::dot(p, p) < 1e-4);
  return p;
}

SceneFile study_scene(const std::string& name) {
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

std::vector<ViewCells> places_of(const ViewCells& cells, std::uint32_t places, std::uint32_t each) {
  std::vector<ViewCells> found;
  for (std::uint32_t i = 0; i < places; ++i) {
    const std::uint64_t middle = (2 * std::uint64_t{i} + 1) * cells.count() / (2 * places);
    const auto first = static_cast<std::uint32_t>(middle - std::min<std::uint64_t>(middle, each / 2));
    found.push_back(part_of(cells, first, each));
  }
  return found;
}

Study::Study(std::string name, const Scene& scene, std::vector<ViewCells> places)
    : name_(std::move(name)),
      scene_(scene),
      places_(std::move(places)),
      caster_(scene),
      rays_(scene, caster_) {}

void Study::run(const std::string& producer, const std::string& settings, bool tells_hidden, bool tells_seen,
                const std::function<Sight(const ViewCells&, JobRunner&)>& produce, double preparing_ms) {
  Run run{producer, settings, tells_hidden, tells_seen, {}, {}, {}, {}, preparing_ms};
  ThreadJobRunner one(1);
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

std::string Study::lines(std::uint64_t& wrong) {
  const ViewCells all = joined(places_);
  std::vector<std::uint32_t> ids(all.count());
  std::iota(ids.begin(), ids.end(), 0);
  ThreadJobRunner runner;
  const VisibilityMatrix dense = dense_reference(rays_, all, ids, runner);
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
    csv += csv_line(name_, scene_.object_of_triangle.size(), scene_.object_count, ids.size(), run.producer,
                    csv_quoted(run.settings), median(run.ms), quantile(run.ms, 0), quantile(run.ms, 1),
                    median(run.wall_ms), run.preparing_ms, text(run.tells_hidden, not_hidden / cells),
                    text(run.tells_seen, seen / cells), known / cells,
                    text(run.tells_hidden, not_hidden / known), text(run.tells_seen, seen / known),
                    text(run.tells_hidden, (not_hidden - seen) / cells / scene_.object_count),
                    text(run.tells_hidden, static_cast<double>(hidden_wrongly)));
  }
  return csv;
}

}  // namespace vismat::bench
