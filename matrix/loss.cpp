#include "matrix/loss.h"

#include <stdexcept>
#include <string>

namespace vismat {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return part == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string text(Shape shape) {
  return std::to_string(shape.rows) + " x " + std::to_string(shape.columns);
}

}  // namespace

double Loss::lost() const {
  return share(added, hidden());
}
double Loss::added_share() const {
  return share(added, visible);
}
double Loss::lost_in(std::uint32_t row) const {
  return share(rows[row].added, shape.columns - rows[row].visible);
}
std::uint32_t Loss::worst_row() const {
  std::uint32_t worst = 0;
  for (std::uint32_t r = 1; r < shape.rows; ++r) {
    if (lost_in(r) > lost_in(worst)) worst = r;
  }
  return worst;
}

Loss loss_of(const VisibilityMatrix& lossy, const VisibilityMatrix& original) {
  return loss_of(lossy, Partition::identity(lossy.shape().rows), original);
}

Loss loss_of(const VisibilityMatrix& merged, const Partition& rows, const VisibilityMatrix& original) {
  const Shape stands_for = {rows.size(), merged.shape().columns};
  if (stands_for != original.shape()) {
    throw std::invalid_argument("stands for " + text(stands_for) + ", but the original has " +
                                text(original.shape()));
  }
  Loss loss;
  loss.shape = original.shape();
  loss.visible = original.ones();
  loss.rows.reserve(loss.shape.rows);
  for (std::uint32_t r = 0; r < loss.shape.rows; ++r) {
    const auto seen = merged.row(rows.group_of_member()[r]), must = original.row(r);
    std::uint32_t missing = 0;
    std::size_t i = 0;
    for (const std::uint32_t column : must) {
      while (i < seen.size() && seen[i] < column) ++i;
      if (i < seen.size() && seen[i] == column) continue;
      if (!loss.first_missing) loss.first_missing = Loss::Entry{r, column};
      ++missing;
    }
    const auto visible = static_cast<std::uint32_t>(must.size());
    const std::uint32_t added = static_cast<std::uint32_t>(seen.size()) - (visible - missing);
    loss.rows.push_back({visible, added});
    loss.added += added;
    loss.missing += missing;
  }
  return loss;
}

}  // namespace vismat
