// A viewer's walk from view cell to view cell along lists of differences.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/deltas.h"

namespace vismat {

/// A viewer that walks from cell to cell and knows what is visible from the present one [Chhugani et al. 2005, section
/// 7]. Allocates nothing once its buffers have held the longest row.
class DifferenceWalk {
 public:
  /// Begins outside, where nothing is visible. `deltas` is borrowed. Throws std::invalid_argument as BoundaryMap does,
  /// and if there are not two lists for each boundary.
  explicit DifferenceWalk(const Deltas& deltas);
  explicit DifferenceWalk(Deltas&&) = delete;
  /// Begins in `cell`, from which `visible`, ascending, is seen.
  DifferenceWalk(const Deltas& deltas, std::uint32_t cell, std::span<const std::uint32_t> visible);

  std::uint32_t cell() const { return cell_; }
  /// What is visible from cell(), ascending. Borrowed until the next go().
  std::span<const std::uint32_t> visible() const { return std::span(visible_).first(count_); }
  const BoundaryMap& map() const { return map_; }
  /// Walks on to the cell `to` and returns how it crossed the boundary. Throws std::invalid_argument, and stays where
  /// it is, if no boundary leads to `to` or its lists do not fit.
  Crossing go(std::uint32_t to);

 private:
  const Deltas& deltas_;
  BoundaryMap map_;
  std::uint32_t cell_ = Boundary::outside;
  std::vector<std::uint32_t> visible_, next_;  // as long as the longest row so far
  std::size_t count_ = 0;
};

/// The crossings that lead along `way` from cell to cell. Each is checked to lead to the right row of `cells`, from
/// which `deltas` were made; throws std::logic_error if one does not.
std::vector<Crossing> crossings_of(const Deltas& deltas, const VisibilityMatrix& cells,
                                   std::span<const std::uint32_t> way);

}  // namespace vismat
