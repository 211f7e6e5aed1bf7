// ALGORITHM. A grid whose planes are the surface's own: for each axis the coordinates of the triangles that stand square
// to it, the twelve with most area, each as two planes where rounding spread them, so that what is rough about a wall stays
// between the two; if any area is left over, twelve equal steps as well. A grid cell is free if no triangle enters it, and
// inside if rays along z say so. The largest box of inside cells is found by running over all ranges of layers and, in
// each, over the maximal rectangles of its plan by the stack method. All that is only a search: a box counts because, in
// the end, no triangle enters it and the winding number of its middle is not 0, both tested against all triangles. Equal
// steps alone lost a cell at each wall, a third of the thickness of thin ones.
#include "visibility/shadows/inner_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace vismat {
namespace {

constexpr std::size_t planes_an_axis = 12;  // 37 grid lines at most: 2 * 10^6 steps a box
constexpr int equal_steps = 12;
constexpr double least_gain = 0.02;  // of the first box's

struct SquaresPlane {
  double low, high, area;
};

struct Grid {
  std::array<std::vector<double>, 3> lines;
  std::vector<std::uint8_t> inside;  // x fastest
  std::vector<double> unused;        // volume that no box holds yet, summed from the origin up to each corner
  std::size_t size(int axis) const { return lines[axis].size() - 1; }
  std::size_t cell(std::size_t x, std::size_t y, std::size_t z) const {
    return x + size(0) * (y + size(1) * z);
  }
  std::size_t corner(std::size_t x, std::size_t y, std::size_t z) const {
    return x + (size(0) + 1) * (y + (size(1) + 1) * z);
  }
  double side(int axis, std::size_t from, std::size_t to) const {
    return lines[axis][to] - lines[axis][from];
  }
};

using Range = std::array<std::array<std::size_t, 2>, 3>;  // of grid lines, an axis each

std::vector<double> grid_lines(std::vector<SquaresPlane> squares, double low, double high, bool all_square,
                               double tolerance) {
  std::sort(squares.begin(), squares.end(),
            [](const SquaresPlane& a, const SquaresPlane& b) { return a.low < b.low; });
  std::vector<SquaresPlane> planes;
  for (const SquaresPlane& square : squares) {
    if (!planes.empty() && square.high - planes.back().low <= 4 * tolerance &&
        square.low - planes.back().high <= tolerance) {
      planes.back().high = std::max(planes.back().high, square.high);
      planes.back().area += square.area;
    } else {
      planes.push_back(square);
    }
  }
  const bool too_many = planes.size() > planes_an_axis;
  if (too_many) {
    std::stable_sort(planes.begin(), planes.end(),
                     [](const SquaresPlane& a, const SquaresPlane& b) { return a.area > b.area; });
    planes.resize(planes_an_axis);
  }
  std::vector<double> lines = {low, high};
  for (const SquaresPlane& plane : planes) lines.insert(lines.end(), {plane.low, plane.high});
  if (too_many || !all_square) {
    for (int i = 1; i < equal_steps; ++i) lines.push_back(low + (high - low) * i / equal_steps);
  }
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return lines;
}

Grid grid_of(const Mesh& mesh, double tolerance) {
  Bounds whole;
  std::array<std::vector<SquaresPlane>, 3> squares;
  double area = 0, square_area = 0;
  for (const std::array<std::uint32_t, 3>& t : mesh.triangles) {
    const glm::dvec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const auto [least, most] = bounds_of(std::array{a, b, c});
    grow(whole, least), grow(whole, most);
    const double this_area = glm::length(glm::cross(b - a, c - a)) / 2;
    area += this_area;
    for (int axis = 0; axis < 3; ++axis) {
      if (most[axis] - least[axis] > tolerance) continue;
      squares[axis].push_back({least[axis], most[axis], this_area});
      square_area += this_area;
      break;
    }
  }
  const bool all_square = square_area >= 0.999 * area;
  Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    grid.lines[axis] =
        grid_lines(std::move(squares[axis]), whole.low[axis], whole.high[axis], all_square, tolerance);
  }
  return grid;
}

/// The cells of an axis whose open interior [low, high] meets: from, to.
std::array<std::size_t, 2> cells_between(const std::vector<double>& lines, double low, double high) {
  const auto from = std::upper_bound(lines.begin(), lines.end(), low) - lines.begin();
  const auto to = std::lower_bound(lines.begin(), lines.end(), high) - lines.begin();
  return {
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(from - 1, 0)),
      static_cast<std::size_t>(std::min<std::ptrdiff_t>(to, static_cast<std::ptrdiff_t>(lines.size()) - 1))};
}

void mark_inside(const Mesh& mesh, Grid& grid) {
  const auto& [xs, ys, zs] = grid.lines;
  const std::size_t nx = grid.size(0), ny = grid.size(1), nz = grid.size(2);
  std::vector<std::uint8_t> entered(nx * ny * nz);
  std::vector<int> winding(nx * ny * nz);  // first: changes at the cell and below; then summed
  // Rays stand off the cells' middles, where diagonals of rectangles pass.
  const auto ray = [](const std::vector<double>& lines, std::size_t i, double at) {
    return lines[i] + at * (lines[i + 1] - lines[i]);
  };
  for (const std::array<std::uint32_t, 3>& t : mesh.triangles) {
    const std::array<glm::dvec3, 3> at = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const auto [least, most] = bounds_of(at);
    const auto [x0, x1] = cells_between(xs, least.x, most.x);
    const auto [y0, y1] = cells_between(ys, least.y, most.y);
    const auto [z0, z1] = cells_between(zs, least.z, most.z);
    const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
    for (std::size_t y = y0; y < y1; ++y) {
      for (std::size_t x = x0; x < x1; ++x) {
        for (std::size_t z = z0; z < z1; ++z) {
          std::uint8_t& mark = entered[grid.cell(x, y, z)];
          if (!mark) mark = enters_box(at, {{xs[x], ys[y], zs[z]}, {xs[x + 1], ys[y + 1], zs[z + 1]}});
        }
        if (normal.z == 0) continue;
        const double px = ray(xs, x, 0.4142), py = ray(ys, y, 0.5772);
        int round = 0;
        for (unsigned i = 0; i < 3; ++i) {
          const glm::dvec3 &a = at[i], &b = at[(i + 1) % 3];
          if ((a.y > py) == (b.y > py)) continue;
          const glm::dvec3 &below = a.y > b.y ? b : a, &above = a.y > b.y ? a : b;
          if (px < below.x + (py - below.y) / (above.y - below.y) * (above.x - below.x))
            round += b.y > a.y ? 1 : -1;
        }
        if (round == 0) continue;
        const double pz = at[0].z - (normal.x * (px - at[0].x) + normal.y * (py - at[0].y)) / normal.z;
        std::size_t under = 0;  // cells whose middle is below
        while (under < nz && (zs[under] + zs[under + 1]) / 2 < pz) ++under;
        if (under > 0) winding[grid.cell(x, y, under - 1)] += round;
      }
    }
  }
  grid.inside.assign(nx * ny * nz, 0);
  for (std::size_t y = 0; y < ny; ++y) {
    for (std::size_t x = 0; x < nx; ++x) {
      int sum = 0;
      for (std::size_t z = nz; z-- > 0;) {
        sum += winding[grid.cell(x, y, z)];
        grid.inside[grid.cell(x, y, z)] = sum != 0 && !entered[grid.cell(x, y, z)];
      }
    }
  }
}

void sum_unused(Grid& grid, const std::vector<std::uint8_t>& used) {
  const std::size_t nx = grid.size(0), ny = grid.size(1), nz = grid.size(2);
  grid.unused.assign((nx + 1) * (ny + 1) * (nz + 1), 0);
  for (std::size_t z = 0; z < nz; ++z) {
    for (std::size_t y = 0; y < ny; ++y) {
      double row = 0;
      for (std::size_t x = 0; x < nx; ++x) {
        const std::size_t cell = grid.cell(x, y, z);
        if (grid.inside[cell] && !used[cell])
          row += grid.side(0, x, x + 1) * grid.side(1, y, y + 1) * grid.side(2, z, z + 1);
        grid.unused[grid.corner(x + 1, y + 1, z + 1)] = row + grid.unused[grid.corner(x + 1, y, z + 1)] +
                                                        grid.unused[grid.corner(x + 1, y + 1, z)] -
                                                        grid.unused[grid.corner(x + 1, y, z)];
      }
    }
  }
}

double unused_in(const Grid& grid, const Range& r) {
  double sum = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const unsigned i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
    const double value = grid.unused[grid.corner(r[0][i], r[1][j], r[2][k])];
    sum += (i + j + k) % 2 == 1 ? value : -value;
  }
  return sum;
}

/// A quarter of the surface is the mean silhouette.
double silhouette(double x, double y, double z) {
  return (x * y + y * z + z * x) / 2;
}

struct Best {
  double gain = 0;
  Range range{};
};

Best largest_box(const Grid& grid, double smallest) {
  const std::size_t nx = grid.size(0), ny = grid.size(1), nz = grid.size(2);
  Best best;
  std::vector<std::uint8_t> plan(nx * ny);
  std::vector<std::size_t> depth(nx), stack;  // depth: free cells of the column, from row y back
  for (std::size_t bottom = 0; bottom < nz; ++bottom) {
    std::fill(plan.begin(), plan.end(), std::uint8_t{1});
    for (std::size_t top = bottom + 1; top <= nz; ++top) {
      bool any = false;
      for (std::size_t i = 0; i < nx * ny; ++i) any |= (plan[i] &= grid.inside[i + nx * ny * (top - 1)]);
      if (!any) break;
      const double height = grid.side(2, bottom, top);
      if (silhouette(grid.side(0, 0, nx), grid.side(1, 0, ny), height) <= best.gain) continue;
      std::fill(depth.begin(), depth.end(), std::size_t{0});
      for (std::size_t y = 0; y < ny; ++y) {
        for (std::size_t x = 0; x < nx; ++x) depth[x] = plan[x + nx * y] ? depth[x] + 1 : 0;
        stack.clear();
        for (std::size_t x = 0; x <= nx; ++x) {
          while (!stack.empty() && (x == nx || depth[stack.back()] >= depth[x])) {
            const std::size_t rows = depth[stack.back()];
            stack.pop_back();
            const std::size_t left = stack.empty() ? 0 : stack.back() + 1;
            if (rows == 0) continue;
            const double a = grid.side(0, left, x), b = grid.side(1, y + 1 - rows, y + 1);
            const double whole = silhouette(a, b, height);
            if (whole <= best.gain || std::max(std::min(a, b), std::min(std::max(a, b), height)) < smallest)
              continue;
            const Range range = {{{left, x}, {y + 1 - rows, y + 1}, {bottom, top}}};
            const double gain = whole * unused_in(grid, range) / (a * b * height);
            if (gain > best.gain) best = {gain, range};
          }
          if (x < nx) stack.push_back(x);
        }
      }
    }
  }
  return best;
}

}  // namespace

std::vector<Bounds> inner_boxes(const Mesh& mesh, unsigned most, double smallest, double tolerance) {
  std::vector<Bounds> boxes;
  if (mesh.triangles.empty()) return boxes;
  Grid grid = grid_of(mesh, tolerance);
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.lines[axis].size() < 2) return boxes;  // flat
  }
  mark_inside(mesh, grid);
  std::vector<std::uint8_t> used(grid.inside.size());
  double first_gain = 0;
  for (unsigned tried = 0; tried < most; ++tried) {
    sum_unused(grid, used);
    const Best best = largest_box(grid, smallest);
    if (best.gain <= least_gain * first_gain) break;
    first_gain = std::max(first_gain, best.gain);
    const auto& [x, y, z] = best.range;
    for (std::size_t k = z[0]; k < z[1]; ++k) {
      for (std::size_t j = y[0]; j < y[1]; ++j) {
        for (std::size_t i = x[0]; i < x[1]; ++i) used[grid.cell(i, j, k)] = 1;
      }
    }
    const Bounds box = {{grid.lines[0][x[0]], grid.lines[1][y[0]], grid.lines[2][z[0]]},
                        {grid.lines[0][x[1]], grid.lines[1][y[1]], grid.lines[2][z[1]]}};
    if (!enters_box(mesh, box) && winding_number(mesh, (box.low + box.high) / 2.0) != 0) {
      boxes.push_back(box);
    }
  }
  return boxes;
}

}  // namespace vismat
