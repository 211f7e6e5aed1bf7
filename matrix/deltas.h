// A visibility matrix stored as what changes between view cells that touch, which a viewer applies as it walks.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// A boundary between two view cells that touch, from < to. From outside, where nothing is visible, one boundary leads into
/// each part of the cells that the others join: into its least cell, all of whose objects then appear.
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

/// The differences between neighbouring cells. `neighbours` is rows x rows and symmetric; that a cell is its own neighbour is
/// ignored. Throws
/// std::invalid_argument, naming a cell, where it is not so. O(the two rows' lengths, summed over the boundaries).
Deltas deltas_of(const VisibilityMatrix& cells, const VisibilityMatrix& neighbours);

/// The inverse of deltas_of. Throws std::invalid_argument, naming the boundary, where the boundaries are not as Deltas says, are
/// not half as many as the lists, or where two ways into a cell differ in what is visible from it. Takes the time of
/// deltas_of and the memory of the cells, which may be many times larger than the lists; throws std::bad_alloc at the start
/// where there is none.
VisibilityMatrix cells_of(const Deltas& deltas);

/// Which cells the boundaries join: cells x cells, symmetric, so that deltas_of(cells_of(d), neighbours_of(d.boundaries)) == d.
/// Throws as BoundaryMap does.
VisibilityMatrix neighbours_of(std::span<const Boundary> boundaries);

/// Throws std::invalid_argument unless there are two lists a boundary.
void check_lists(const Deltas& deltas);
/// "cell 7" or "outside", for messages.
std::string cell_name(std::uint32_t cell);

/// A boundary that is crossed in one of its two directions, which tells the rows of Deltas::lists to apply.
struct Crossing {
  std::uint32_t boundary;
  bool back;  // from its `to` to its `from`
  std::uint32_t appears() const { return 2 * boundary + back; }
  std::uint32_t vanishes() const { return 2 * boundary + !back; }
};

/// Finds the boundary between two cells, and the neighbours of one. O(boundaries) to make; takes 16 bytes for each.
class BoundaryMap {
 public:
  /// Throws std::invalid_argument, naming the boundary, unless they are as Deltas says and every cell below the
  /// greatest one is reached.
  explicit BoundaryMap(std::span<const Boundary> boundaries);

  std::uint32_t cells() const { return static_cast<std::uint32_t>(begin_.size() - 2); }
  /// Ascending; outside comes last where it is a neighbour. The cell may itself be outside.
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

}  // namespace vismat
