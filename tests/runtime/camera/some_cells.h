// View cells of every kind, small.
#pragma once
#include <string>
#include <vector>

#include "visibility/cells/grid_cells.h"
#include "visibility/cells/ground_cells.h"
#include "visibility/cells/octree_cells.h"
#include "visibility/generators/city.h"
#include "visibility/generators/dense_city.h"

namespace vismat::test {

struct SomeCells {
  std::string name;
  SceneFile file;
};

/// A slope, a stair of 0.3 m steps and level ground beside one another.
inline Scene hillside() {
  Scene scene;
  const auto quad = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const auto first = static_cast<std::uint32_t>(scene.vertices.size());
    scene.vertices.insert(scene.vertices.end(), {a, b, c, d});
    scene.indices.insert(scene.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    scene.object_of_triangle.insert(scene.object_of_triangle.end(), 2, scene.object_count++);
  };
  quad({0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0});
  for (int step = 1; step <= 4; ++step) {
    const float x = 10 + 2 * float(step - 1), z = 0.3f * float(step);
    quad({x, 0, z}, {x + 2, 0, z}, {x + 2, 5, z}, {x, 5, z});
  }
  quad({10, 5, 0}, {18, 5, 1.2f}, {18, 10, 1.2f}, {10, 10, 0});
  quad({18, 0, 1.2f}, {25, 0, 1.2f}, {25, 10, 1.2f}, {18, 10, 1.2f});
  return scene;
}

inline std::vector<SomeCells> some_cells() {
  std::vector<SomeCells> all;
  all.push_back({"city", make_city({.size = 4})});
  all.push_back({"city with eyes at many heights", make_city({.size = 4, .eye_low = 1, .eye_high = 2.5f})});
  all.push_back({"dense city", make_dense_city({.size = 3, .step = 8, .interiors = 0, .car_sides = 8})});
  SceneFile grid = make_city({.size = 4});
  GridCellsOptions above;
  above.size = {5, 5, 5};
  above.region = Box{{0, 0, 0}, {80, 80, 40}};
  grid.cells = make_grid_cells(grid.scene, above);
  all.push_back({"grid", grid});
  OctreeCellsOptions divided;
  divided.threshold = 10;
  divided.levels = 4;
  divided.region = above.region;
  grid.cells =
      make_octree_cells(
          grid.scene,
          [](const ViewCells& cells) {  // small ones near one corner
            std::vector<std::uint64_t> triangles;
            for (const Box& box : cells.boxes)
              triangles.push_back(box.low[0] + box.low[1] < 50 ? 11 : box.high[0] - box.low[0] > 11 ? 11 : 0);
            return triangles;
          },
          divided)
          .cells;
  all.push_back({"octree", grid});
  SceneFile hill;
  hill.scene = hillside();
  hill.cells = make_ground_cells(hill.scene);
  all.push_back({"hillside", hill});
  return all;
}

}  // namespace vismat::test
