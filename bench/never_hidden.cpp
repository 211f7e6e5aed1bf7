// No ray may reach an object that was reported hidden. Rays run from random points of view cells, half of them at objects that are
// hidden from there, half anywhere; what they reach is looked up in what the shadow producer left. A ray of floats may slip
// past an edge, so each that seems to reach a hidden object is checked again in rational arithmetic: a violation is one that
// holds; the others are counted as slips. Scenes: cities, their cells touching walls; soups; tilted boxes, some cells in
// them, some flat, 1e5 m away too; a plant; levels that are named.
//   never_hidden [--rays N] [LEVEL ...]     exit 1 if there is a violation
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <mutex>
#include <string>
#include <vector>

#include "matrix/base/parallel.h"
#include "programs/progress.h"
#include "visibility/exact/witness.h"
#include "visibility/generators/city.h"
#include "visibility/generators/dense_city.h"
#include "visibility/generators/plant.h"
#include "visibility/levels/level_file.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/scene_file.h"

namespace {

using namespace vismat;

struct Place {
  std::string name;
  Scene scene;
  ViewCells cells;
};

void add_tilted_box(Scene& scene, Random& random, const glm::vec3& at, float size) {
  glm::vec3 axis[3];
  for (glm::vec3& a : axis) {
    do {
      for (int k = 0; k < 3; ++k) a[k] = random.between(-1, 1);
    } while (glm::length(a) < 0.1f);
  }
  axis[0] = glm::normalize(axis[0]);
  axis[1] = glm::normalize(glm::cross(axis[0], axis[1]));
  axis[2] = glm::cross(axis[0], axis[1]);
  for (glm::vec3& a : axis) a *= size * random.between(0.2f, 1);
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (unsigned c = 0; c < 8; ++c) {
    glm::vec3 p = at;
    for (int k = 0; k < 3; ++k) p += (c >> k & 1 ? 1.0f : -1.0f) * axis[k];
    scene.vertices.push_back(p);
  }
  for (const auto& [a, b, c, d] :
       {std::array{0u, 4u, 6u, 2u}, std::array{1u, 3u, 7u, 5u}, std::array{0u, 1u, 5u, 4u},
        std::array{2u, 6u, 7u, 3u}, std::array{0u, 2u, 3u, 1u}, std::array{4u, 5u, 7u, 6u}}) {
    for (const std::uint32_t corner : {a, b, c, a, c, d}) scene.indices.push_back(first + corner);
    scene.object_of_triangle.insert(scene.object_of_triangle.end(), 2, scene.object_count);
  }
  ++scene.object_count;
}

void add_triangle(Scene& scene, Random& random, const glm::vec3& at, float size) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.vertices.push_back(
        at + size * glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)));
    scene.indices.push_back(first + i);
  }
  scene.object_of_triangle.push_back(scene.object_count++);
}

// Cells of 4 m all over a cube of 100 m; each third one flat, each ninth a line.
ViewCells cells_anywhere(Random& random, std::uint32_t count, float offset) {
  ViewCells cells;
  for (std::uint32_t i = 0; i < count; ++i) {
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = offset + random.between(0, 96);
      box.high[k] = box.low[k] + random.between(0.5f, 4);
    }
    if (i % 3 == 0) box.high[i / 3 % 3] = box.low[i / 3 % 3];
    if (i % 9 == 0) box.high[(i / 3 + 1) % 3] = box.low[(i / 3 + 1) % 3];
    cells.boxes.push_back(box);
  }
  return cells;
}

using Add = void (*)(Scene&, Random&, const glm::vec3&, float);
Place scattered(const char* name, Add add, std::uint32_t objects, float size, float offset) {
  Random random(7);
  Place place{name, {}, {}};
  for (std::uint32_t i = 0; i < objects; ++i) {
    const glm::vec3 at(random.between(0, 100), random.between(0, 100), random.between(0, 100));
    add(place.scene, random, at + offset, size);
  }
  place.cells = cells_anywhere(random, 180, offset);
  return place;
}

Place from(const char* name, SceneFile file) {
  return {name, std::move(file.scene), std::move(file.cells)};
}

struct Count {
  std::uint64_t rays = 0, cells = 0, hidden = 0, slips = 0, violations = 0;
  std::string first;
};

Count shoot(const Place& place, std::uint64_t rays, std::uint32_t most_cells, std::uint32_t patches,
            unsigned threads, const Progress& progress) {
  const RayCaster caster(place.scene);
  const AimedRays aim(place.scene, caster);
  const WitnessCheck check(place.scene);
  const Shadows shadows(place.scene, occluders_for(place.scene, place.cells, {}));
  ShadowOptions casting;
  casting.points = 9, casting.resolution = casting.patch_resolution = 256, casting.patches = patches;
  const std::uint32_t count = std::min(most_cells, place.cells.count());
  const std::uint64_t packets = rays / count / RayCaster::width + 1;

  Count sum;
  std::mutex mutex;
  parallel_for(
      count, threads,
      [&](std::uint64_t i) {
        const auto cell = static_cast<std::uint32_t>(i * place.cells.count() / count);
        const CellPoints points(convex_of(place.cells, cell));
        const auto view = shadows.view(casting);
        const auto around = view->not_hidden(points.cell());
        std::vector<char> hidden(place.scene.object_count, 1);
        for (const std::uint32_t object : view->refined(points.cell(), around, around)) hidden[object] = 0;
        std::vector<std::uint32_t> targets;
        for (std::uint32_t o = 0; o < hidden.size(); ++o) {
          if (hidden[o] && aim.has_area(o)) targets.push_back(o);
        }
        Count now;
        now.cells = 1, now.hidden = targets.size(), now.rays = packets * RayCaster::width;
        Random random(3, cell);
        for (std::uint64_t packet = 0; packet < packets; ++packet) {
          std::array<glm::vec3, RayCaster::width> origins, directions;
          origins.fill(points.on_face(random));
          for (unsigned k = 0; k < RayCaster::width; ++k) {
            if (k % 2 == 0 && !targets.empty()) {
              directions[k] =
                  aim.point_of(targets[random.below(static_cast<std::uint32_t>(targets.size()))], random) -
                  origins[k];
            } else {
              for (int axis = 0; axis < 3; ++axis) directions[k][axis] = random.between(-1, 1);
            }
            if (directions[k] == glm::vec3(0)) directions[k].x = 1;
          }
          const auto hits = caster.hits(origins, directions, RayCaster::width, false);
          for (unsigned k = 0; k < RayCaster::width; ++k) {
            if (hits[k].triangle == Hit::nothing) continue;
            const std::uint32_t object = place.scene.object_of_triangle[hits[k].triangle];
            if (!hidden[object]) continue;
            const SightLine line{origins[k], origins[k] + hits[k].distance * directions[k]};
            if (check.seen(points.cell(), object, line)) {
              ++now.slips;
              continue;
            }
            if (now.violations++ == 0) {
              char text[200];
              std::snprintf(text, sizeof text,
                            "cell %u, object %u: from (%.9g, %.9g, %.9g) to (%.9g, %.9g, %.9g)", cell, object,
                            line.from.x, line.from.y, line.from.z, line.to.x, line.to.y, line.to.z);
              now.first = text;
            }
          }
        }
        const std::scoped_lock lock(mutex);
        sum.rays += now.rays, sum.cells += now.cells, sum.hidden += now.hidden;
        sum.slips += now.slips, sum.violations += now.violations;
        if (sum.first.empty() || (!now.first.empty() && now.first < sum.first)) sum.first = now.first;
      },
      progress);
  return sum;
}

int run(int argc, char** argv) {
  CLI::App app("Does any ray reach what is reported hidden?");
  std::vector<std::string> levels;
  double rays = 1e6;
  std::uint32_t cells = 12, patches = 24;
  unsigned threads = 0;
  app.add_option(
      "LEVEL", levels,
      "Quake-3 levels to take as well, FILE.pk3:maps/NAME.bsp; their clusters' boxes are the cells");
  app.add_option("--rays", rays, "Altogether")->capture_default_str();
  app.add_option("--cells", cells, "Of each scene, at most")->capture_default_str();
  app.add_option("--patches", patches, "Of a cell's boundary")->capture_default_str();
  app.add_option("--threads", threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  std::vector<std::function<Place()>> places = {
      [] {
        CityOptions options;
        options.size = 16;
        return from("city", make_city(options));
      },
      [] {
        DenseCityOptions options;
        options.size = 8;
        return from("dense city", make_dense_city(options));
      },
      [] {
        PlantOptions options;
        options.size = 2;
        return from("plant", make_plant(options));
      },
      [] { return scattered("soup", add_triangle, 2000, 20, 0); },
      [] { return scattered("large soup", add_triangle, 500, 50, 0); },
      [] { return scattered("tilted boxes", add_tilted_box, 300, 12, 0); },
      [] { return scattered("tilted boxes, far away", add_tilted_box, 300, 12, 1e5f); }};
  for (const std::string& where : levels) {
    places.push_back([where] {
      Level level = read_level(where);
      Place place{level.name, std::move(level.face_scene), {}};
      for (const Box& box : level.cell_bounds) {
        if (box != Box{}) place.cells.boxes.push_back(box);
      }
      return place;
    });
  }

  Count all;
  std::printf("%-40s %6s %14s %12s %8s %10s\n", "scene", "cells", "hidden a cell", "rays", "slips",
              "violations");
  const auto print = [](const std::string& name, const Count& c) {
    const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    std::printf("%-40s %6llu %14.1f %12llu %8llu %10llu\n", name.c_str(), number(c.cells),
                static_cast<double>(c.hidden) / static_cast<double>(std::max<std::uint64_t>(1, c.cells)),
                number(c.rays), number(c.slips), number(c.violations));
    if (!c.first.empty()) std::printf("  %s\n", c.first.c_str());
    std::fflush(stdout);
  };
  for (const auto& make : places) {
    const Place place = make();
    const Count c = shoot(place, static_cast<std::uint64_t>(rays / static_cast<double>(places.size())), cells,
                          patches, threads, cli::show_progress(place.name));
    print(place.name, c);
    all.rays += c.rays, all.cells += c.cells, all.hidden += c.hidden, all.slips += c.slips,
        all.violations += c.violations;
  }
  print("all", all);
  return all.violations == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try { return run(argc, argv); } catch (const std::exception& error) {
  std::fprintf(stderr, "never_hidden: %s\n", error.what());
  return 1;
}
