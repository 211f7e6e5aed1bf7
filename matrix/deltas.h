// A visibility matrix as what changes between view cells that touch: what paper 000 stores, and a viewer applies.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// Between two view cells that touch, from < to. From outside, where nothing is visible, one boundary leads into each part
/// of the cells that the others join: into its least cell, which then appears whole.
struct Boundary {
  static constexpr std::uint32_t outside = 0xffffffff;
  std::uint32_t from = outside, to = 0;
  bool operator==(const Boundary&) const = default;
};

/// What appears and vanishes between neighbouring cells [Chhugani et al. 2005, 6 and 6.1].
struct Deltas {
  std::vector<Boundary> boundaries;  // those from outside first, then by ascending from, then to
  /// Two rows a boundary b: row 2b lists what appears on the way from -> to, row 2b + 1 what vanishes; on the way
  /// back they change places.
  VisibilityMatrix lists;
  bool operator==(const Deltas&) const = default;
};

/// `neighbours` is rows x rows and symmetric; that a cell is its own neighbour is ignored. Throws
/// std::invalid_argument, naming a cell, where it is not so. O(the two rows' lengths, summed over the boundaries).
Deltas deltas_of(const VisibilityMatrix& cells, const VisibilityMatrix& neighbours);

/// The inverse. Throws std::invalid_argument, naming the boundary, where the boundaries are not as Deltas says, are
/// not half as many as the lists, or where two ways into a cell differ in what is visible from it. Time as deltas_of;
/// memory: the cells, which may be any times larger than the lists; std::bad_alloc before the first where there is none.
VisibilityMatrix cells_of(const Deltas& deltas);

/// Which cells the boundaries join: cells x cells, symmetric, so that deltas_of(cells_of(d), neighbours_of(d.boundaries)) == d.
/// Throws as BoundaryMap does.
VisibilityMatrix neighbours_of(std::span<const Boundary> boundaries);

/// A boundary on the way across it; the rows of Deltas::lists to apply.
struct Crossing {
  std::uint32_t boundary;
  bool back;  // from its `to` to its `from`
  std::uint32_t appears() const { return 2 * boundary + back; }
  std::uint32_t vanishes() const { return 2 * boundary + !back; }
};

/// Which cells touch, and by which boundary. O(boundaries) to make; 16 bytes each.
class BoundaryMap {
 public:
  /// Throws std::invalid_argument, naming the boundary, unless they are as Deltas says and every cell below the
  /// greatest one is reached.
  explicit BoundaryMap(std::span<const Boundary> boundaries);

  std::uint32_t cells() const { return static_cast<std::uint32_t>(begin_.size() - 2); }
  /// Ascending; outside is the last where it is one. The cell may itself be outside.
  std::span<const std::uint32_t> neighbours(std::uint32_t cell) const;
  /// None where the two do not touch. O(log neighbours).
  std::optional<Crossing> crossing(std::uint32_t from, std::uint32_t to) const;

 private:
  std::size_t place(std::uint32_t cell) const { return cell == Boundary::outside ? cells() : cell; }
  std::vector<std::uint64_t> begin_;  // of each cell's part of the two below; outside comes behind the cells
  std::vector<std::uint32_t> neighbours_, boundaries_;
};

/// Writes `visible` with `appears` and without `vanishes`; each ascends. `result` has room for the first two, and is
/// none of them; returns how much of it is filled. Throws std::invalid_argument, naming the id, where one appears
/// that was visible or vanishes that was not. O((appears + vanishes) log visible) steps besides copying.
std::size_t cross(std::span<const std::uint32_t> visible, std::span<const std::uint32_t> appears,
                  std::span<const std::uint32_t> vanishes, std::span<std::uint32_t> result);

/// What is visible from one cell after the other [Chhugani et al. 2005, 7]. Allocates nothing once its buffers have
/// held the longest row.
class Walk {
 public:
  /// Begins outside. `deltas` is borrowed; throws std::invalid_argument as BoundaryMap does, and where there are not
  /// two lists a boundary.
  explicit Walk(const Deltas& deltas);
  explicit Walk(Deltas&&) = delete;

  std::uint32_t cell() const { return cell_; }
  std::span<const std::uint32_t> visible() const {
    return std::span(visible_).first(count_);
  }  // until the next go
  const BoundaryMap& map() const { return map_; }
  /// Throws std::invalid_argument and stays where it is, if no boundary leads to `to` or its lists do not fit.
  void go(std::uint32_t to);

 private:
  const Deltas& deltas_;
  BoundaryMap map_;
  std::uint32_t cell_ = Boundary::outside;
  std::vector<std::uint32_t> visible_, next_;  // as long as the longest row so far
  std::size_t count_ = 0;
};

}  // namespace vismat
