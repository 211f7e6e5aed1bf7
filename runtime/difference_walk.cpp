#include "runtime/difference_walk.h"

#include <algorithm>
#include <stdexcept>

namespace vismat {

DifferenceWalk::DifferenceWalk(const Deltas& deltas) : deltas_(deltas), map_(deltas.boundaries) {
  check_lists(deltas);
}

DifferenceWalk::DifferenceWalk(const Deltas& deltas, std::uint32_t cell,
                               std::span<const std::uint32_t> visible)
    : DifferenceWalk(deltas) {
  cell_ = cell;
  visible_.assign(visible.begin(), visible.end());
  count_ = visible.size();
}

Crossing DifferenceWalk::go(std::uint32_t to) {
  const auto crossing = map_.crossing(cell_, to);
  if (!crossing)
    throw std::invalid_argument("no boundary leads from " + cell_name(cell_) + " to " + cell_name(to));
  const auto appears = deltas_.lists.row(crossing->appears()),
             vanishes = deltas_.lists.row(crossing->vanishes());
  if (next_.size() < count_ + appears.size()) next_.resize(count_ + appears.size());
  count_ = cross(visible(), appears, vanishes, next_);
  visible_.swap(next_);
  cell_ = to;
  return *crossing;
}

std::vector<Crossing> crossings_of(const Deltas& deltas, const VisibilityMatrix& cells,
                                   std::span<const std::uint32_t> way) {
  std::vector<Crossing> crossings;
  if (way.empty()) return crossings;
  DifferenceWalk walk(deltas, way[0], cells.row(way[0]));
  for (const std::uint32_t cell : way.subspan(1)) {
    crossings.push_back(walk.go(cell));
    if (!std::ranges::equal(walk.visible(), cells.row(cell)))
      throw std::logic_error("a boundary leads to another row");
  }
  return crossings;
}

}  // namespace vismat
