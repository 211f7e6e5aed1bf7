// A visibility matrix stored as its differences: what changes between view cells that touch, which a viewer applies on
// the way.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// A boundary between two view cells that touch, from < to. In addition, one boundary leads from outside, where nothing
/// is visible, into the lowest-numbered cell of each connected part of the cells; all objects of that cell then appear.
struct Boundary {
  static constexpr std::uint32_t outside = 0xffffffff;
  std::uint32_t from = outside, to = 0;
  bool operator==(const Boundary&) const = default;
};

/// What appears and vanishes between neighbouring cells [Chhugani et al. 2005, sections 6 and 6.1].
struct Deltas {
  std::vector<Boundary> boundaries;  // those from outside first; ascending by `from`, then `to`
  /// Two rows for each boundary b. Row 2b lists what appears on the way from `from` to `to`, row 2b + 1 what vanishes.
  /// On the way back the two change places.
  VisibilityMatrix lists;
  bool operator==(const Deltas&) const = default;
};

/// The differences between neighbouring cells. `neighbours` is a symmetric matrix of rows x rows; a cell that is its
/// own neighbour is ignored. Throws std::invalid_argument, naming a cell, if `neighbours` has another shape or is not
/// symmetric. O(the lengths of both rows, summed over the boundaries).
Deltas deltas_of(const VisibilityMatrix& cells, const VisibilityMatrix& neighbours);

/// The inverse of deltas_of. Throws std::invalid_argument, naming the boundary, if the boundaries are not as Deltas
/// says, are not half as many as the lists, or if two ways into a cell differ in what is visible from it. Takes the
/// time of deltas_of and the memory of the cells, which may be many times larger than the lists; throws std::bad_alloc
/// at the start if there is not enough.
VisibilityMatrix cells_of(const Deltas& deltas);

/// Which cells the boundaries join: a symmetric matrix of cells x cells, so that deltas_of(cells_of(d),
/// neighbours_of(d.boundaries)) == d. Throws as BoundaryMap does.
VisibilityMatrix neighbours_of(std::span<const Boundary> boundaries);

/// Throws std::invalid_argument unless there are two lists for each boundary.
void check_lists(const Deltas& deltas);
/// The cell as messages name it: "cell 7" or "outside".
std::string cell_name(std::uint32_t cell);

/// A boundary that is crossed in one of its two directions, which decides what the rows of Deltas::lists mean.
struct Crossing {
  std::uint32_t boundary;
  bool back;  // from its `to` to its `from`
  std::uint32_t appears() const { return 2 * boundary + back; }
  std::uint32_t vanishes() const { return 2 * boundary + !back; }
};

/// Finds the boundary between two cells, and the neighbours of a cell. Takes O(boundaries) time to make, and 16 bytes
/// for each boundary.
class BoundaryMap {
 public:
  /// Throws std::invalid_argument, naming the boundary, unless the boundaries are as Deltas says and every cell up to
  /// the highest-numbered one is reached.
  explicit BoundaryMap(std::span<const Boundary> boundaries);

  std::uint32_t cells() const { return static_cast<std::uint32_t>(begin_.size() - 2); }
  /// The neighbours of the cell, ascending; outside comes last if it is one. The cell may itself be outside.
  std::span<const std::uint32_t> neighbours(std::uint32_t cell) const;
  /// The crossing from one to the other; nothing if the two do not touch. O(log neighbours).
  std::optional<Crossing> crossing(std::uint32_t from, std::uint32_t to) const;

 private:
  std::size_t place(std::uint32_t cell) const { return cell == Boundary::outside ? cells() : cell; }
  std::vector<std::uint64_t> begin_;  // of each cell's part of the two below; outside comes behind the cells
  std::vector<std::uint32_t> neighbours_, boundaries_;
};

/// Writes to `result` what is visible after a crossing: `visible` with `appears` added and `vanishes` taken away, all
/// of which ascend. `result` must not overlap them and has room for the first two. Returns how many ids are written.
/// Throws std::invalid_argument, naming the id, if one appears that was visible or vanishes that was not. O((appears +
/// vanishes) log visible) steps besides copying.
std::size_t cross(std::span<const std::uint32_t> visible, std::span<const std::uint32_t> appears,
                  std::span<const std::uint32_t> vanishes, std::span<std::uint32_t> result);

}  // namespace vismat
