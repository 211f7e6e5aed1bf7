// Measures where and why producers of visibility fail: accuracy against raster, view cell and triangle size, the gain of each kind of
// occluder, slivers, cracks, walls close together, gaps narrower than a pixel, cells at occluders, far coordinates, levels of detail.
//
// Writes FOLDER/failures.csv (each line judged as in `bench visibility-tables`) and FOLDER/detail.csv. Ends with exit code 1 if an object is
// reported hidden that a ray reaches or that is seen by construction, or if a level of detail moves a point by more than a pixel.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "bench/visibility_study.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/generators/dense_city.h"
#include "visibility/meshes/components.h"

namespace vismat::bench {
namespace {

struct VisibilityFailuresOptions {
  std::filesystem::path out = ".";
  std::uint32_t places = 4, each = 2;
  std::vector<std::string> only;
};

class Failures {
 public:
  explicit Failures(const VisibilityFailuresOptions& options) : options_(options) {}

  std::vector<ViewCells> places(const ViewCells& cells) const {
    return places_of(cells, options_.places, options_.each);
  }
  void add(const std::string& what, const std::string& value, Study& study) {
    const std::string lines = study.lines(wrong_);
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t end = lines.find('\n', at) + 1;
      csv_ += csv_quoted(what) + "," + csv_quoted(value) + "," + lines.substr(at, end - at);
      at = end;
    }
    std::printf("%s, %s\n%s", what.c_str(), value.c_str(), lines.c_str());
    std::fflush(stdout);
    write_table(options_.out / "failures.csv", csv_);
  }
  /// Single shadows with each of `occluders`.
  void shadows(const std::string& what, const std::string& value, const Scene& scene,
               std::vector<ViewCells> cells,
               std::vector<std::pair<std::string, std::vector<Occluder>>> occluders) {
    Study study("", scene, std::move(cells));
    for (auto& [name, these] : occluders) {
      const Shadows shadows(scene, std::move(these));
      study.run("shadow", name, true, false, [&](const ViewCells& part, JobRunner& runner) {
        return see_bounds(shadows, nullptr, part, effort(0), runner);
      });
    }
    add(what, value, study);
  }
  void expect(bool right, const std::string& what) {
    if (right) return;
    ++wrong_;
    std::fprintf(stderr, "wrong: %s\n", what.c_str());
  }
  std::uint64_t wrong() const { return wrong_; }

 private:
  VisibilityFailuresOptions options_;
  std::string csv_ = std::string("study,value,") + Study::header;
  std::uint64_t wrong_ = 0;
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Every triangle hides for itself, as where nobody looks for solids and flat faces.
std::vector<Occluder> triangles_of(const Scene& scene) {
  std::vector<Occluder> occluders;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    std::array<glm::dvec3, 3> corners;
    for (unsigned k = 0; k < 3; ++k) corners[k] = scene.vertices[scene.indices[3 * t + k]];
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (!(glm::length(normal) > 0)) continue;
    Occluder occluder;
    occluder.shape = convex_polygon(corners, normal / glm::length(normal));
    occluder.object = scene.object_of_triangle[t];
    occluder.flat = true;
    occluders.push_back(std::move(occluder));
  }
  std::stable_sort(occluders.begin(), occluders.end(),
                   [](const Occluder& a, const Occluder& b) { return a.object < b.object; });
  return occluders;
}

void sizes(Failures& failures) {
  const SceneFile city = make_dense_city();
  const Shadows shadows(city.scene, find_occluders(city.scene));
  {
    Study study("", city.scene, failures.places(city.cells));
    for (const std::uint32_t resolution : {32, 64, 128, 256, 512, 1024, 2048}) {
      BoundsOptions options = effort(0);
      options.shadow.resolution = resolution;
      study.run("shadow", std::to_string(resolution), true, false,
                [&](const ViewCells& part, JobRunner& runner) {
                  return see_bounds(shadows, nullptr, part, options, runner);
                });
    }
    failures.add("raster", "", study);
  }
  for (const float side : {0.5f, 1.f, 2.f, 4.f, 8.f}) {
    Study study("", city.scene, failures.places(resized(city.cells, side / 4)));
    for (const unsigned level : {0, 1}) {
      study.run(level == 0 ? "shadow" : "sandwich", "effort " + std::to_string(level), true, level > 0,
                [&](const ViewCells& part, JobRunner& runner) {
                  return see_bounds(shadows, &study.rays(), part, effort(level), runner);
                });
    }
    failures.add("cell", number(side), study);
  }
  OccluderOptions no_boxes, no_polygons, no_ground, large;
  no_boxes.boxes_per_object = 0;
  no_polygons.polygons_per_object = 0;
  no_ground.extend_below_ground = false;
  large.smallest = 4;
  failures.shadows("occluders", "", city.scene, failures.places(city.cells),
                   {{"all", find_occluders(city.scene)},
                    {"no boxes inside", find_occluders(city.scene, no_boxes)},
                    {"no polygons", find_occluders(city.scene, no_polygons)},
                    {"not below ground", find_occluders(city.scene, no_ground)},
                    {"none below 4 m", find_occluders(city.scene, large)},
                    {"single triangles", triangles_of(city.scene)}});
}

void triangle_sizes(Failures& failures) {
  for (const float step : {0.6f, 1.2f, 2.4f, 5.f, 40.f}) {
    DenseCityOptions options;
    options.size = 10;
    options.step = step;
    const SceneFile city = make_dense_city(options);
    failures.shadows(
        "triangles", number(step), city.scene, failures.places(city.cells),
        {{"occluders", find_occluders(city.scene)}, {"single triangles", triangles_of(city.scene)}});
  }
}

// ---- one wall before a few boxes -------------------------------------------------------------------------------------------

struct Rectangle {
  double left = -20, right = 20, low = -20, high = 20, at = 10;
};

/// Across the y axis, in `columns` x `rows` rectangles; with `apart`, each triangle has vertices of its own, that far off.
void add_wall(Scene& scene, const Rectangle& r, unsigned columns, unsigned rows, double apart = 0) {
  std::vector<glm::dvec3> corners;
  std::vector<std::uint32_t> indices;
  Random random(3);
  const auto vertex = [&](unsigned x, unsigned z) {
    glm::dvec3 p(r.left + (r.right - r.left) * x / columns, r.at, r.low + (r.high - r.low) * z / rows);
    if (apart > 0) p += apart * in_unit_ball(random);
    return p;
  };
  for (unsigned x = 0; x < columns; ++x) {
    for (unsigned z = 0; z < rows; ++z) {
      for (const auto& [u, v] : {std::pair(0u, 0u), std::pair(1u, 0u), std::pair(1u, 1u), std::pair(0u, 0u),
                                 std::pair(1u, 1u), std::pair(0u, 1u)}) {
        indices.push_back(static_cast<std::uint32_t>(indices.size()));
        corners.push_back(vertex(x + u, z + v));
      }
    }
  }
  add_object(scene, corners, indices);
  if (apart == 0) weld(scene);
}

/// 40 m behind the cell's middle, 81 boxes, of which a whole wall hides all.
void add_targets(Scene& scene) {
  for (int x = -4; x <= 4; ++x) {
    for (int z = -4; z <= 4; ++z)
      add_box(scene, {3. * x, 40, 3. * z}, {{{.5, 0, 0}, {0, .5, 0}, {0, 0, .5}}});
  }
}

std::vector<ViewCells> one_cell(const Box& box) {
  ViewCells cells;
  cells.boxes = {box};
  return {cells};
}
const Box middle_cell{{-1, -1, -1}, {1, 1, 1}};

void walls_apart(Failures& failures) {
  const auto with_found = [&](const char* what, const std::string& value, Scene scene,
                              const Box& cell = middle_cell) {
    add_targets(scene);
    auto occluders = find_occluders(scene);
    failures.shadows(what, value, scene, one_cell(cell), {{"occluders", std::move(occluders)}});
  };
  for (const unsigned columns : {1u, 10u, 100u, 1000u, 4000u}) {
    Scene scene;
    add_wall(scene, {}, columns, 1);
    with_found("slivers", "one triangle in " + number(40. / columns) + " m", std::move(scene));
  }
  for (const double apart : {0., 1e-6, 1e-4, 1e-3}) {
    for (const bool weld_it : {false, true}) {
      if (weld_it && apart == 0) continue;
      Scene scene;
      add_wall(scene, {}, 8, 8, apart);
      if (weld_it) weld(scene, static_cast<float>(4 * apart));
      with_found("cracks", (apart == 0 ? "none" : number(apart) + " m") + (weld_it ? ", welded" : ""),
                 std::move(scene));
    }
  }
  for (const double between : {0., 1e-6, 1e-4, 1e-2, 1.}) {
    Scene scene;
    add_wall(scene, {}, 8, 8);
    add_wall(scene, {-4, 4, -4, 4, 10 - between}, 3, 3);  // seen, but for what lies exactly in the other
    with_found("walls close together", number(between) + " m", std::move(scene));
  }
  for (const double gap : {1., 0.1, 1e-2, 1e-3, 1e-4}) {
    Scene scene;
    add_wall(scene, {-20, -gap / 2, -20, 20, 10}, 4, 8);
    add_wall(scene, {gap / 2, 20, -20, 20, 10}, 4, 8);
    add_targets(scene);
    // The five columns at |x| < 6 are seen through the gap from the cell's points 1 m to either side: (40 - 10) / 9 = 3.3 m.
    const Shadows shadows(scene, find_occluders(scene));
    ThreadJobRunner runner;
    const Sight sight = see_bounds(shadows, nullptr, one_cell(middle_cell)[0], effort(0), runner);
    for (std::uint32_t object = 2; object < scene.object_count; ++object) {
      const int column = static_cast<int>((object - 2) / 9) - 4;
      const auto row = sight.not_hidden.row(0);
      if (std::abs(column) <= 1) {
        failures.expect(std::binary_search(row.begin(), row.end(), object),
                        "object " + std::to_string(object) + " behind a gap of " + number(gap) + " m");
      }
    }
    failures.shadows("gap", number(gap) + " m", scene, one_cell(middle_cell),
                     {{"occluders", find_occluders(scene)}});
  }
  for (const float distance : {1.f, 0.1f, 1e-3f, 1e-6f, 0.f, -0.1f}) {
    Scene scene;
    add_wall(scene, {}, 8, 8);
    with_found("cell at a wall", number(double{distance}) + " m", std::move(scene),
               {{-1, 8 - distance, -1}, {1, 10 - distance, 1}});
  }
}

void far_away(Failures& failures) {
  for (const float offset : {0.f, 1e3f, 1e4f, 1e5f, 1e6f}) {
    DenseCityOptions options;
    options.size = 8;
    SceneFile city = make_dense_city(options);
    for (glm::vec3& vertex : city.scene.vertices) vertex += glm::vec3(offset, offset, 0);
    for (Box& box : city.cells.boxes) {
      for (int k = 0; k < 2; ++k) box.low[k] += offset, box.high[k] += offset;
    }
    failures.shadows("far away", number(double{offset}) + " m", city.scene, failures.places(city.cells),
                     {{"occluders", find_occluders(city.scene)}});
  }
}

// ---- levels of detail ------------------------------------------------------------------------------------------------------

/// The point of a triangle nearest to p.
glm::dvec3 nearest(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area = glm::dot(normal, normal);
  if (area > 0) {
    const glm::dvec3 foot = p - normal * (glm::dot(p - t[0], normal) / area);
    bool inside = true;
    for (unsigned k = 0; k < 3; ++k) {
      inside = inside && glm::dot(glm::cross(t[(k + 1) % 3] - t[k], foot - t[k]), normal) >= 0;
    }
    if (inside) return foot;
  }
  glm::dvec3 best = t[0];
  for (unsigned k = 0; k < 3; ++k) {
    const glm::dvec3 edge = t[(k + 1) % 3] - t[k];
    const double length = glm::dot(edge, edge);
    const glm::dvec3 on =
        t[k] + edge * (length > 0 ? std::clamp(glm::dot(p - t[k], edge) / length, 0., 1.) : 0.);
    if (glm::distance(on, p) < glm::distance(best, p)) best = on;
  }
  return best;
}

/// How far the original's vertices are from the level that is drawn for the cell, in pixels, from viewpoints of the cell: to
/// the nearest point of the level, so not less than the least that could be seen.
std::uint64_t detail(const VisibilityFailuresOptions& options) {
  DenseCityOptions city_options;
  city_options.size = 6;
  const SceneFile city = make_dense_city(city_options);
  const Screen screen;
  const double per_radian = pixels_per_radian(screen);
  const LevelsOfDetail lods(city.scene, screen);
  const std::vector<Box> bounds = object_bounds(city.scene);
  std::string csv =
      "rule,objects,coarser,triangles_full,triangles,median_pixels,most_pixels,over_one_pixel\n";
  std::uint64_t wrong = 0;
  for (const bool whole_cell : {true, false}) {
    Random random(11);
    std::vector<double> deviations;
    std::uint64_t objects = 0, full = 0, drawn = 0, over = 0;
    for (const ViewCells& part : places_of(city.cells, 12, 1)) {
      const Box cell = part.boxes[0];
      Box from = cell;
      if (!whole_cell) {
        for (int k = 0; k < 3; ++k) from.low[k] = from.high[k] = (cell.low[k] + cell.high[k]) / 2;
      }
      for (std::uint32_t object = 1; object < city.scene.object_count; object += 3) {
        const std::uint32_t level = lods.level_for(from, object);
        const LevelOfDetail& now = lods.levels(object)[level];
        ++objects, full += lods.levels(object)[0].triangles.size(), drawn += now.triangles.size();
        if (level == 0) continue;
        const Mesh& mesh = lods.mesh(object);
        double most = 0;
        for (int sample = 0; sample < 40; ++sample) {
          const glm::dvec3 p = mesh.vertices[random.below(static_cast<std::uint32_t>(mesh.vertices.size()))];
          glm::dvec3 q = p;
          double distance = INFINITY;
          for (const auto& triangle : now.triangles) {
            const glm::dvec3 near = nearest(
                p, {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]});
            if (glm::distance(near, p) < distance) distance = glm::distance(near, p), q = near;
          }
          for (unsigned corner = 0; corner < 8; ++corner) {
            glm::dvec3 eye;
            for (int k = 0; k < 3; ++k) eye[k] = double{(corner >> k & 1 ? cell.high : cell.low)[k]};
            const glm::dvec3 a = p - eye, b = q - eye;
            most = std::max(most, per_radian * std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
          }
        }
        deviations.push_back(most);
        over += most > 1;
      }
    }
    csv += csv_line(whole_cell ? "from all of the cell" : "from its centre alone", objects, deviations.size(),
                    full, drawn, median(deviations), quantile(deviations, 1), over);
    if (whole_cell) wrong += over;
  }
  std::printf("%s", csv.c_str());
  write_table(options.out / "detail.csv", csv);
  return wrong;
}

void run_visibility_failures(const VisibilityFailuresOptions& options) {
  const auto wanted = [&](const char* name) {
    return options.only.empty() || std::ranges::find(options.only, name) != options.only.end();
  };
  Failures failures(options);
  if (wanted("walls")) walls_apart(failures);
  if (wanted("far")) far_away(failures);
  if (wanted("triangles")) triangle_sizes(failures);
  if (wanted("sizes")) sizes(failures);
  const std::uint64_t wrong = failures.wrong() + (wanted("detail") ? detail(options) : 0);
  if (wrong > 0) throw std::runtime_error(std::to_string(wrong) + " answers are wrong");
}

}  // namespace

void add_visibility_failures(const Verb& verb) {
  const auto o = std::make_shared<VisibilityFailuresOptions>();
  verb.output("--out", o->out, Written::folder, "Folder for the tables");
  verb.option("--places", o->places, "Number of places, spread over a city").between(1u, 1000u);
  verb.option("--cells", o->each, "Number of view cells at each place").between(1u, 1000u);
  verb.option("--only", o->only, "Only these studies")
      .comma_separated()
      .one_of({"walls", "far", "triangles", "sizes", "detail"});
  verb.example("bench visibility-failures --only walls,far --out out");
  verb.runs([o] { run_visibility_failures(*o); });
}

}  // namespace vismat::bench
