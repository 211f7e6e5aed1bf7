// Words to options; every word is read in full, so "grid:4m" is refused rather than taken for 4.
#include "visibility/cells/cells_choice.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "matrix/base/number_list.h"

namespace vismat {
namespace {

constexpr const char* ways =
    "file, grid:SIZE, grid:X,Y,Z, ground, ground:HEIGHT, octree:TRIANGLES or octree:TRIANGLES:LEVELS";

[[noreturn]] void refuse(const std::string& option, const std::string& word, const std::string& right) {
  throw std::invalid_argument(option + " '" + word + "': need " + right);
}

std::vector<float> numbers(std::string_view text, const std::array<double, 3>& origin = {}) {
  std::vector<float> values;
  for (const double value : number_list(text))
    values.push_back(static_cast<float>(value - origin[values.size() % 3]));
  return values;
}

std::optional<Box> region_of(const std::string& words, const std::array<double, 3>& origin) {
  if (words.empty()) return std::nullopt;
  const std::vector<float> v = numbers(words, origin);
  if (v.size() != 6 || !(v[0] <= v[3] && v[1] <= v[4] && v[2] <= v[5])) {
    refuse("--region", words, "six numbers x,y,z,x,y,z: the low corner, then the high one");
  }
  return Box{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

Viewers viewers_of(const CellsWords& words, const std::array<double, 3>& origin) {
  Viewers viewers;
  for (const std::string& start : words.from) {
    const std::vector<float> v = numbers(start, origin);
    if (v.size() != 3) refuse("--from", start, "a point x,y,z where a viewer starts");
    viewers.from.emplace_back(v[0], v[1], v[2]);
  }
  if (!words.eyes.empty()) {
    const std::vector<float> v = numbers(words.eyes);
    if (v.empty() || v.size() > 2 || !(v.front() >= 0 && v.front() <= v.back())) {
      refuse("--eyes", words.eyes, "a height above the ground, or two, the lower first");
    }
    viewers.eyes = {v.front(), v.back()};
  }
  return viewers;
}

std::string joined(std::initializer_list<float> values) {
  std::string text;
  for (const float value : values) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%s%.9g", text.empty() ? "" : ",", value);
    text += digits;
  }
  return text;
}

std::string describe_place(const std::optional<Box>& region, const Viewers& viewers) {
  std::string text;
  if (region) {
    const auto &l = region->low, &h = region->high;
    text += ", region " + joined({l[0], l[1], l[2], h[0], h[1], h[2]});
  }
  for (const glm::vec3& start : viewers.from) text += ", from " + joined({start.x, start.y, start.z});
  if (viewers.eyes) text += ", eyes " + joined({(*viewers.eyes)[0], (*viewers.eyes)[1]}) + " m";
  return text;
}

}  // namespace

CellsChoice parse_cells(const CellsWords& words, const std::array<double, 3>& origin) {
  const std::vector<std::string_view> parts = split(words.cells, ':');
  const std::optional<Box> region = region_of(words.region, origin);
  const Viewers viewers = viewers_of(words, origin);
  if (parts[0] == "file" && parts.size() == 1) {
    if (region || !viewers.from.empty() || viewers.eyes) {
      throw std::invalid_argument(
          "--region, --from and --eyes are for view cells that are made: give --cells too");
    }
    return {};
  }
  if (parts[0] == "grid" && parts.size() == 2) {
    const std::vector<float> v = numbers(parts[1]);
    if (v.size() != 1 && v.size() != 3)
      refuse("--cells", words.cells, "one size in metres, or three: grid:4 or grid:4,4,1.5");
    GridCellsOptions grid;
    grid.size = v.size() == 1 ? glm::vec3(v[0]) : glm::vec3(v[0], v[1], v[2]);
    grid.region = region;
    grid.viewers = viewers;
    return grid;
  }
  if (parts[0] == "ground" && parts.size() <= 2) {
    GroundCellsOptions ground;
    if (parts.size() == 2) {
      const std::vector<float> v = numbers(parts[1]);
      if (v.size() != 1) refuse("--cells", words.cells, "the height of level ground: ground:HEIGHT");
      ground.height = v[0] - static_cast<float>(origin[2]);
    }
    ground.region = region;
    ground.viewers.from = viewers.from;
    if (viewers.eyes) ground.viewers.eyes = viewers.eyes;
    return ground;
  }
  if (parts[0] == "octree" && (parts.size() == 2 || parts.size() == 3)) {
    OctreeCellsOptions octree;
    const auto threshold = number_of<std::uint64_t>(parts[1]);
    const auto levels = parts.size() == 3 ? number_of<unsigned>(parts[2]) : octree.levels;
    if (!threshold || !levels)
      refuse("--cells", words.cells, "whole numbers: octree:TRIANGLES or octree:TRIANGLES:LEVELS");
    octree.threshold = *threshold;
    octree.levels = *levels;
    octree.region = region;
    octree.viewers = viewers;
    return octree;
  }
  refuse("--cells", words.cells, ways);
}

std::string describe(const CellsChoice& choice) {
  if (const auto* grid = std::get_if<GridCellsOptions>(&choice)) {
    return "grid cells: " + joined({grid->size.x, grid->size.y, grid->size.z}) + " m" +
           describe_place(grid->region, grid->viewers);
  }
  if (const auto* ground = std::get_if<GroundCellsOptions>(&choice)) {
    return "ground cells" + (ground->height ? ": height " + joined({*ground->height}) + " m" : "") +
           ", at most " + joined({ground->steepest}) + " degrees, steps " + joined({ground->step}) +
           " m, radius " + joined({ground->radius}) + " m, pieces from " + joined({ground->smallest}) +
           " m2" + describe_place(ground->region, ground->viewers);
  }
  if (const auto* octree = std::get_if<OctreeCellsOptions>(&choice)) {
    return "octree cells: at most " + std::to_string(octree->threshold) + " visible triangles, " +
           std::to_string(octree->levels) + " levels" + describe_place(octree->region, octree->viewers);
  }
  return "the file's cells";
}

ChosenCells choose_cells(const Scene& scene, const ViewCells& of_file, const CellsChoice& choice,
                         const VisibleTriangles& count) {
  if (const auto* grid = std::get_if<GridCellsOptions>(&choice)) return {make_grid_cells(scene, *grid), ""};
  if (const auto* ground = std::get_if<GroundCellsOptions>(&choice))
    return {make_ground_cells(scene, *ground), ""};
  if (const auto* octree = std::get_if<OctreeCellsOptions>(&choice)) {
    OctreeCells made = make_octree_cells(scene, count, *octree);
    std::string table = table_of(made);
    return {std::move(made.cells), std::move(table)};
  }
  if (of_file.count() == 0) {
    throw std::invalid_argument(
        std::string("the scene has no view cells of its own; make some by --cells: ") + ways);
  }
  return {of_file, ""};
}

std::vector<std::uint64_t> triangles_of_rows(const VisibilityMatrix& objects, const Scene& scene) {
  std::vector<std::uint64_t> of_object(scene.object_count), of_row(objects.shape().rows);
  for (const std::uint32_t object : scene.object_of_triangle) ++of_object[object];
  for (std::uint32_t row = 0; row < of_row.size(); ++row) {
    for (const std::uint32_t object : objects.row(row)) of_row[row] += of_object[object];
  }
  return of_row;
}

}  // namespace vismat
