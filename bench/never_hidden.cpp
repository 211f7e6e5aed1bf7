// Checks that no ray reaches an object that was reported hidden. Rays run from random points of view cells, half of them at objects
// that are hidden from there, half in any direction. No object that they reach may be one that the shadow producer reported hidden. A
// ray in floating point may slip past an edge, so each ray that seems to reach a hidden object is checked again in rational
// arithmetic. If it does reach it, that is a violation, and the verb ends with exit code 1; if not, it is counted as a slip. Scenes:
// cities whose view cells touch walls; triangle soups; tilted boxes, some around view cells, some flat, also 1e5 m away; a plant;
// and the levels that are named.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "bench/visibility_study.h"
#include "matrix/base/parallel.h"
#include "programs/progress.h"
#include "visibility/exact/witness.h"
#include "visibility/generators/city.h"
#include "visibility/generators/dense_city.h"
#include "visibility/generators/plant.h"
#include "visibility/levels/level_file.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/scene_file.h"

namespace vismat::bench {
namespace {

struct NeverHiddenOptions {
  std::vector<std::string> levels;
  double rays = 1e6;
  std::uint32_t cells = 12, patches = 24;
  unsigned threads = 0;
};

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
  std::array<glm::dvec3, 8> corners;
  for (unsigned c = 0; c < 8; ++c) {
    glm::vec3 p = at;
    for (int k = 0; k < 3; ++k) p += (c >> k & 1 ? 1.0f : -1.0f) * axis[k];
    corners[c] = p;
  }
  add_box(scene, corners);
}

void add_triangle(Scene& scene, Random& random, const glm::vec3& at, float size) {
  std::array<glm::dvec3, 3> corners;
  for (glm::dvec3& corner : corners)
    corner = at + size * glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  constexpr std::uint32_t indices[] = {0, 1, 2};
  add_object(scene, corners, indices);
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

Count shoot(const Place& place, std::uint64_t rays, const NeverHiddenOptions& options,
            const Progress& progress) {
  const RayCaster caster(place.scene);
  const AimedRays aim(place.scene, caster);
  const WitnessCheck check(place.scene);
  const Shadows shadows(place.scene, occluders_for(place.scene, place.cells, {}));
  ShadowOptions casting;
  casting.points = 9, casting.resolution = casting.patch_resolution = 256, casting.patches = options.patches;
  const std::uint32_t count = std::min(options.cells, place.cells.count());
  const std::uint64_t packets = rays / count / RayCaster::width + 1;

  Count sum;
  std::mutex mutex;
  parallel_for(
      count, options.threads,
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

void run_never_hidden(const NeverHiddenOptions& options) {
  std::vector<std::function<Place()>> places = {
      [] {
        CityOptions city;
        city.size = 16;
        return from("city", make_city(city));
      },
      [] {
        DenseCityOptions city;
        city.size = 8;
        return from("dense city", make_dense_city(city));
      },
      [] {
        PlantOptions plant;
        plant.size = 2;
        return from("plant", make_plant(plant));
      },
      [] { return scattered("soup", add_triangle, 2000, 20, 0); },
      [] { return scattered("large soup", add_triangle, 500, 50, 0); },
      [] { return scattered("tilted boxes", add_tilted_box, 300, 12, 0); },
      [] { return scattered("tilted boxes, far away", add_tilted_box, 300, 12, 1e5f); }};
  for (const std::string& where : options.levels) {
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
    std::printf("%-40s %6ju %14.1f %12ju %8ju %10ju\n", name.c_str(), std::uintmax_t{c.cells},
                static_cast<double>(c.hidden) / static_cast<double>(std::max<std::uint64_t>(1, c.cells)),
                std::uintmax_t{c.rays}, std::uintmax_t{c.slips}, std::uintmax_t{c.violations});
    if (!c.first.empty()) std::printf("  %s\n", c.first.c_str());
    std::fflush(stdout);
  };
  for (const auto& make : places) {
    const Place place = make();
    const auto rays = static_cast<std::uint64_t>(options.rays / static_cast<double>(places.size()));
    const Count c = shoot(place, rays, options, cli::show_progress(place.name));
    print(place.name, c);
    all.rays += c.rays, all.cells += c.cells, all.hidden += c.hidden, all.slips += c.slips,
        all.violations += c.violations;
  }
  print("all", all);
  if (all.violations > 0)
    throw std::runtime_error(std::to_string(all.violations) +
                             " rays reach objects that were reported hidden");
}

}  // namespace

void add_never_hidden(const Verb& verb) {
  const auto o = std::make_shared<NeverHiddenOptions>();
  verb.input("LEVEL", o->levels,
             "Quake 3 levels to check as well, FILE.bsp or FILE.pk3:maps/NAME.bsp; their clusters' boxes "
             "are the view cells");
  verb.option("--rays", o->rays, "Number of rays in all");
  verb.option("--cells", o->cells, "Largest number of view cells of each scene");
  verb.option("--patches", o->patches, "Number of patches of a view cell's surface");
  verb.threads(o->threads);
  verb.example("bench never-hidden --rays 1e7 oa_koth1.bsp");
  verb.runs([o] { run_never_hidden(*o); });
}

}  // namespace vismat::bench
