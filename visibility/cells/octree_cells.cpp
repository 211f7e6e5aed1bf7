// ALGORITHM. Breadth first, so that a whole level can be counted at once by many threads or processes. Where viewers can be is
// found beforehand on the grid of the smallest cells; each coarser level is the OR of eight. The paper stops at a cell's
// visible triangles and at the level, as we do; what it does with parts of the expanded bounding box inside of solids it does
// not say. All corners come from one formula over the finest grid, so cells of different levels touch exactly.
#include "visibility/cells/octree_cells.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "matrix/base/z_order.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat {
namespace {

using Place = std::array<std::uint32_t, 3>;  // of a cell among those of its level

/// Where viewers can be, for one level: a grid with half the cells of the finer one along each axis.
struct Reachable {
  Place count{};
  std::vector<std::uint8_t> cells;
  std::uint64_t index(const Place& at) const {
    return (std::uint64_t{at[2]} * count[1] + at[1]) * count[0] + at[0];
  }
  bool operator()(const Place& at) const {
    for (unsigned axis = 0; axis < 3; ++axis)
      if (at[axis] >= count[axis]) return false;
    return cells[index(at)] != 0;
  }
};

Reachable coarser(const Reachable& fine) {
  Reachable coarse;
  for (unsigned axis = 0; axis < 3; ++axis) coarse.count[axis] = (fine.count[axis] + 1) / 2;
  coarse.cells.resize(std::uint64_t{coarse.count[0]} * coarse.count[1] * coarse.count[2]);
  Place at;
  for (at[2] = 0; at[2] < fine.count[2]; ++at[2]) {
    for (at[1] = 0; at[1] < fine.count[1]; ++at[1]) {
      for (at[0] = 0; at[0] < fine.count[0]; ++at[0]) {
        coarse.cells[coarse.index({at[0] / 2, at[1] / 2, at[2] / 2})] |= fine.cells[fine.index(at)];
      }
    }
  }
  return coarse;
}

}  // namespace

OctreeCells make_octree_cells(const Scene& scene, const VisibleTriangles& count,
                              const OctreeCellsOptions& options) {
  if (options.levels > 10) {
    throw std::invalid_argument("octree cells: " + std::to_string(options.levels) +
                                " levels; at most 10 can be refined");
  }
  const Box region = options.region ? *options.region : bounds_of(scene);
  float side = 0;
  for (unsigned axis = 0; axis < 3; ++axis) side = std::max(side, region.high[axis] - region.low[axis]);
  Box thick = region;  // cubes have no flat layers
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (thick.low[axis] == thick.high[axis]) thick.high[axis] += side / 1024;
  }
  const std::uint32_t finest = 1u << options.levels;
  CellGrid grid = grid_over(thick, glm::vec3(side / static_cast<float>(finest)));
  if (options.region) fit(grid, thick);
  std::vector<Reachable> reachable(options.levels + 1);  // by level, the root's first
  reachable.back() = {grid.count, reachable_cells(scene, grid, options.viewers, 2, options.threads)};
  for (unsigned level = options.levels; level-- > 0;) reachable[level] = coarser(reachable[level + 1]);

  struct Leaf {
    std::uint64_t key;
    Box box;
    std::uint64_t triangles;
  };
  std::vector<Leaf> leaves;
  OctreeCells result;
  result.side = side;
  std::vector<Place> places;
  if (reachable[0]({0, 0, 0})) places.push_back({0, 0, 0});
  if (places.empty()) throw std::invalid_argument("view cells: viewers reach none of the region");
  for (unsigned level = 0; !places.empty(); ++level) {
    const std::uint32_t step = finest >> level;
    ViewCells cells;
    for (const Place& at : places) {
      Box& box = cells.boxes.emplace_back(grid.box(at[0] * step, at[1] * step, at[2] * step, step));
      for (unsigned axis = 0; axis < 3 && options.region; ++axis) {
        box.high[axis] = std::min(box.high[axis], std::max(thick.high[axis], box.low[axis]));
      }
    }
    const std::vector<std::uint64_t> triangles = count(cells);
    if (triangles.size() != places.size()) {
      throw std::invalid_argument("octree cells: " + std::to_string(triangles.size()) +
                                  " counts of triangles for " + std::to_string(places.size()) + " cells");
    }
    OctreeLevel& told = result.levels.emplace_back();
    std::vector<Place> next;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Place& at = places[i];
      const bool over = triangles[i] > options.threshold;
      if (over && level < options.levels) {
        for (std::uint32_t child = 0; child < 8; ++child) {
          const Place below = {2 * at[0] + (child & 1), 2 * at[1] + (child >> 1 & 1),
                               2 * at[2] + (child >> 2)};
          if (reachable[level + 1](below)) next.push_back(below);
        }
        continue;
      }
      leaves.push_back({z_order(at[0] * step, at[1] * step, at[2] * step), cells.boxes[i], triangles[i]});
      ++told.kept;
      told.stopped += over;
      if (over) told.excess += static_cast<double>(triangles[i]);
    }
    told.evaluated = places.size();
    if (told.stopped > 0) {
      told.excess /= static_cast<double>(told.stopped) *
                     static_cast<double>(std::max<std::uint64_t>(options.threshold, 1));
    }
    places = std::move(next);
  }
  std::sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) { return a.key < b.key; });
  for (const Leaf& leaf : leaves) {
    result.cells.boxes.push_back(leaf.box);
    result.triangles.push_back(leaf.triangles);
  }
  result.cells.neighbours = touching_boxes(result.cells.boxes);
  return result;
}

std::string table_of(const OctreeCells& octree) {
  std::string table = "level      side, m  evaluated       kept  over the threshold  by a factor of\n";
  double side = octree.side;
  for (std::size_t level = 0; level < octree.levels.size(); ++level, side /= 2) {
    const OctreeLevel& l = octree.levels[level];
    const double share =
        l.evaluated == 0 ? 0 : 100 * static_cast<double>(l.stopped) / static_cast<double>(l.evaluated);
    char line[128];
    std::snprintf(line, sizeof line, "%5zu %12.3f %10llu %10llu %10llu (%3.0f %%)", level, side,
                  static_cast<unsigned long long>(l.evaluated), static_cast<unsigned long long>(l.kept),
                  static_cast<unsigned long long>(l.stopped), share);
    table += line;
    if (l.stopped > 0) {
      std::snprintf(line, sizeof line, " %15.2f", l.excess);
      table += line;
    }
    table += '\n';
  }
  return table;
}

}  // namespace vismat
