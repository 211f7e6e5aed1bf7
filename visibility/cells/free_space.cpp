// ALGORITHM. A flood fill over the points of a lattice, by rays instead of steps: a ray from a reached point along an axis
// reaches every lattice point before its hit, and tells how far into the next cell it came, so a cell of which only a sliver
// is free is found too. A point keeps a bit for each axis whose line through it is done; with that an open line costs two
// rays however many points lie on it, where a flood by steps casts six a point. Points are scanned in
// blocks; a point waits while the one before it on the line is still to be cast, whose ray mostly saves its own. The set
// reached is a closure, so the order does not show in it. The lattice is set off from the cells' middles by odd fractions:
// walls stand on round coordinates, and a ray within the plane of a wall does not meet it.
#include "visibility/cells/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "matrix/base/parallel.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

constexpr std::uint64_t most_cells = std::uint64_t{1} << 28;
constexpr std::uint64_t most_points = std::uint64_t{1} << 31;
constexpr double infinity = std::numeric_limits<double>::infinity();

class Flood {
 public:
  Flood(const Scene& scene, const CellGrid& grid, const Viewers& viewers, unsigned lines, unsigned threads)
      : caster_(scene), grid_(grid), viewers_(viewers), threads_(threads), entered_(grid.cells()) {
    double greatest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<unsigned>(axis);
      lines_[a] = grid.size[axis] > 0 ? lines : 1;
      points_[a] = grid.count[a] * std::uint64_t{lines_[a]};
      greatest = std::max(
          {greatest, std::abs(grid.low[axis]), std::abs(grid.low[axis] + grid.size[axis] * grid.count[a])});
    }
    for (int axis = 0; axis < 3; ++axis) margin_[axis] = 1e-4 * grid.size[axis] + 2.5e-7 * greatest;
    const std::uint64_t points = points_[0] * points_[1] * points_[2];
    if (points > most_points) {
      throw std::invalid_argument("free space: " + std::to_string(points) +
                                  " lattice points; larger cells or a smaller region would do");
    }
    state_.resize(points);
    if (viewers.from.empty()) {
      from_the_sky(scene);
    } else {
      for (const glm::vec3& start : viewers.from) from_point(start);
    }
    while (pass()) continue;
  }

  std::vector<std::uint8_t> entered() && { return std::move(entered_); }

 private:
  static constexpr std::uint8_t reached = 8;  // and 1, 2, 4: the line along x, y, z is done
  using Index = std::array<std::uint64_t, 3>;

  Index at(std::uint64_t point) const {
    return {point % points_[0], point / points_[0] % points_[1], point / (points_[0] * points_[1])};
  }
  std::uint64_t number(const Index& i) const { return (i[2] * points_[1] + i[1]) * points_[0] + i[0]; }
  std::uint64_t stride(unsigned axis) const {
    return axis == 0 ? 1 : axis == 1 ? points_[0] : points_[0] * points_[1];
  }
  double coordinate(unsigned axis, std::uint64_t i) const {
    static constexpr std::array<double, 3> fraction = {0.4837, 0.5129, 0.5413};
    const auto a = static_cast<int>(axis);
    return grid_.low[a] + (static_cast<double>(i) + fraction[axis]) * grid_.size[a] / lines_[axis];
  }
  glm::vec3 position(const Index& i) const {
    return glm::vec3(coordinate(0, i[0]), coordinate(1, i[1]), coordinate(2, i[2]));
  }

  /// Cells of the line through `i` that have a part between low and high on the axis.
  void enter(Index i, unsigned axis, double low, double high) {
    const auto a = static_cast<int>(axis);
    std::array<std::uint32_t, 3> cell;
    for (unsigned k = 0; k < 3; ++k) cell[k] = static_cast<std::uint32_t>(i[k] / lines_[k]);
    const double cells = grid_.count[axis], origin = grid_.low[a], size = grid_.size[a];
    if (size == 0) {
      if (low <= origin && origin <= high) entered_[grid_.index(cell[0], cell[1], cell[2])] = 1;
      return;
    }
    const auto first = static_cast<std::uint32_t>(std::clamp(std::floor((low - origin) / size), 0.0, cells));
    const auto end =
        static_cast<std::uint32_t>(std::clamp(std::floor((high - origin) / size) + 1, 0.0, cells));
    for (cell[axis] = first; cell[axis] < end; ++cell[axis])
      entered_[grid_.index(cell[0], cell[1], cell[2])] = 1;
  }

  /// The line through `i` is free from low to high, which may be infinite.
  void cover(const Index& i, unsigned axis, double low, double high) {
    const auto a = static_cast<int>(axis);
    const auto inside = [&](double x) { return x > low + margin_[a] && x < high - margin_[a]; };
    if (!inside(coordinate(axis, i[axis]))) return;  // on a wall: no telling on which side of it
    if (!viewers_.eyes) {
      enter(i, axis, low + margin_[a], high - margin_[a]);
    } else if (axis == 2) {
      const double ground = low == -infinity ? grid_.low.z : low;
      const double lowest = ground + (*viewers_.eyes)[0], highest = ground + (*viewers_.eyes)[1];
      if (lowest < high - margin_[2]) enter(i, axis, lowest, std::min(highest, high - margin_[2]));
    }
    if (grid_.size[a] == 0) {
      state_[number(i)] |= static_cast<std::uint8_t>(reached | 1u << axis);
      return;
    }
    const auto mark = [&](std::uint64_t k) {
      if (!inside(coordinate(axis, k))) return false;
      Index j = i;
      j[axis] = k;
      state_[number(j)] |= static_cast<std::uint8_t>(reached | 1u << axis);
      return true;
    };
    for (std::uint64_t k = i[axis]; k < points_[axis] && mark(k); ++k) continue;
    for (std::uint64_t k = i[axis]; k-- > 0 && mark(k);) continue;
  }

  void from_the_sky(const Scene& scene) {
    double top = grid_.low.z + grid_.size.z * grid_.count[2];
    for (const std::uint32_t vertex : scene.indices) top = std::max(top, double{scene.vertices[vertex].z});
    const auto above = static_cast<float>(top + std::max(1.0, 1e-6 * std::abs(top)));
    for (Index i = {0, 0, points_[2] - 1}; i[1] < points_[1]; ++i[1]) {
      for (i[0] = 0; i[0] < points_[0]; ++i[0]) {
        glm::vec3 origin = position(i);
        origin.z = above;
        const Hit hit = caster_.hit(origin, {0, 0, -1});
        const double floor = hit.triangle == Hit::nothing ? -infinity : double{above} - hit.distance;
        if (coordinate(2, i[2]) > floor + margin_[2]) {
          cover(i, 2, floor, infinity);
        } else if (!viewers_.eyes) {
          enter(i, 2, floor + margin_[2], infinity);
        }
      }
    }
  }

  void from_point(const glm::vec3& start) {
    std::array<std::uint32_t, 3> cell;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<int>(axis);
      const double end = grid_.low[a] + grid_.size[a] * grid_.count[axis];
      if (!(start[a] >= grid_.low[a] && start[a] <= end)) {
        throw std::invalid_argument("a viewer cannot start at (" + std::to_string(start.x) + ", " +
                                    std::to_string(start.y) + ", " + std::to_string(start.z) +
                                    "): outside of the region that has view cells");
      }
      cell[axis] = grid_.size[a] > 0
                       ? std::min(static_cast<std::uint32_t>((start[a] - grid_.low[a]) / grid_.size[a]),
                                  grid_.count[axis] - 1)
                       : 0;
    }
    if (!viewers_.eyes) entered_[grid_.index(cell[0], cell[1], cell[2])] = 1;
    Index first, end;  // lattice points of its cell and those around it
    for (unsigned axis = 0; axis < 3; ++axis) {
      first[axis] = std::uint64_t{std::max(cell[axis], 1u) - 1} * lines_[axis];
      end[axis] = std::min(points_[axis], std::uint64_t{cell[axis] + 2} * lines_[axis]);
    }
    Index i;
    for (i[2] = first[2]; i[2] < end[2]; ++i[2]) {
      for (i[1] = first[1]; i[1] < end[1]; ++i[1]) {
        for (i[0] = first[0]; i[0] < end[0]; ++i[0]) {
          const Hit hit = caster_.hit(start, position(i) - start);
          if (hit.triangle == Hit::nothing || hit.distance > 1.0001f) state_[number(i)] |= reached;
        }
      }
    }
  }

  bool pass() {
    static constexpr std::uint64_t block = 1 << 16;
    bool any = false;
    for (std::uint64_t first = 0; first < state_.size(); first += block) {
      while (cast_block(first, std::min<std::uint64_t>(first + block, state_.size()))) any = true;
    }
    return any;
  }

  bool waits(std::uint64_t point, unsigned axis) const {
    return (state_[point] & (reached | 1u << axis)) == reached;
  }

  bool cast_block(std::uint64_t first, std::uint64_t end) {
    struct Line {
      Index at;
      unsigned axis;
      double low = -infinity, high = infinity;
    };
    std::vector<Line> cast;
    for (std::uint64_t point = first; point < end; ++point) {
      if (!(state_[point] & reached) || state_[point] == (reached | 7)) continue;
      const Index i = at(point);
      for (unsigned axis = 0; axis < 3; ++axis) {
        if (waits(point, axis) && !(i[axis] > 0 && waits(point - stride(axis), axis)))
          cast.push_back({i, axis});
      }
    }
    constexpr std::size_t a_packet = RayCaster::width / 2;  // of lines, a ray each way
    const auto cast_packet = [&](std::uint64_t packet) {
      const std::size_t from = packet * a_packet, to = std::min(from + a_packet, cast.size());
      std::array<glm::vec3, RayCaster::width> origins{}, directions{};
      for (std::size_t k = from; k < to; ++k) {
        const std::size_t ray = 2 * (k - from);
        origins[ray] = origins[ray + 1] = position(cast[k].at);
        directions[ray][static_cast<int>(cast[k].axis)] = -1;
        directions[ray + 1][static_cast<int>(cast[k].axis)] = 1;
      }
      const auto hits = caster_.hits(origins, directions, static_cast<unsigned>(2 * (to - from)), false);
      for (std::size_t k = from; k < to; ++k) {
        const Hit &before = hits[2 * (k - from)], &after = hits[2 * (k - from) + 1];
        const double x = coordinate(cast[k].axis, cast[k].at[cast[k].axis]);
        if (before.triangle != Hit::nothing) cast[k].low = x - before.distance;
        if (after.triangle != Hit::nothing) cast[k].high = x + after.distance;
      }
    };
    const std::size_t packets = (cast.size() + a_packet - 1) / a_packet;
    parallel_for(packets, packets < 64 ? 1 : threads_, cast_packet);
    for (const Line& line : cast) {
      cover(line.at, line.axis, line.low, line.high);
      state_[number(line.at)] |= static_cast<std::uint8_t>(1u << line.axis);
    }
    return !cast.empty();
  }

  RayCaster caster_;
  const CellGrid& grid_;
  const Viewers& viewers_;
  unsigned threads_;
  std::array<unsigned, 3> lines_;      // lattice points for each cell
  Index points_;                       // in all
  glm::dvec3 margin_;                  // rays end so far before what they hit
  std::vector<std::uint8_t> state_;    // of lattice points
  std::vector<std::uint8_t> entered_;  // cells
};

}  // namespace

Box CellGrid::box(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t step) const {
  const glm::dvec3 from(x, y, z);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<unsigned>(axis);
    box.low[a] = static_cast<float>(low[axis] + from[axis] * size[axis]);
    box.high[a] = static_cast<float>(low[axis] + (from[axis] + step) * size[axis]);
  }
  return box;
}

CellGrid grid_over(const Box& region, const glm::vec3& size) {
  CellGrid grid;
  double cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<unsigned>(axis);
    const double extent = double{region.high[a]} - region.low[a];
    if (!(extent >= 0 && extent <= 1e10)) {
      throw std::invalid_argument("view cells: the region's high corner must lie beyond its low corner");
    }
    if (!(size[axis] > 0 || (size[axis] == 0 && extent == 0)) || !(size[axis] <= 1e9f)) {
      throw std::invalid_argument("view cells: a cell's size must be above 0 and at most 1e9 m");
    }
    grid.low[axis] = region.low[a];
    grid.size[axis] = extent == 0 ? 0 : double{size[axis]};
    // An extent that is a multiple of the size but for rounding has no sliver of one more cell.
    const double count = extent == 0 ? 1 : std::max(1.0, std::ceil(extent / size[axis] - 1e-4));
    if ((cells *= count) > static_cast<double>(most_cells)) {
      throw std::invalid_argument(
          "view cells: more than 2^28 cells of that size in the region; take larger ones or a smaller "
          "region");
    }
    grid.count[a] = static_cast<std::uint32_t>(count);
  }
  return grid;
}

void fit(CellGrid& grid, const Box& region) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    grid.size[static_cast<int>(axis)] = (double{region.high[axis]} - region.low[axis]) / grid.count[axis];
  }
}

std::vector<std::uint8_t> reachable_cells(const Scene& scene, const CellGrid& grid, const Viewers& viewers,
                                          unsigned lines, unsigned threads) {
  if (viewers.eyes &&
      !((*viewers.eyes)[0] >= 0 && (*viewers.eyes)[0] <= (*viewers.eyes)[1] && (*viewers.eyes)[1] <= 1e9f)) {
    throw std::invalid_argument("eye heights: need two from 0 to 1e9 m, the lower first");
  }
  if (scene.see_through.empty()) return Flood(scene, grid, viewers, lines, threads).entered();
  Scene opaque = scene;
  opaque.see_through.clear();
  return Flood(opaque, grid, viewers, lines, threads).entered();
}

}  // namespace vismat
