#include "matrix/files/entries.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace vismat {

VisibilityMatrix matrix_of_entries(Shape shape, const std::vector<Entry>& entries, std::uint64_t& repeated) {
  std::vector<std::uint64_t> offsets(std::size_t{shape.rows} + 1, 0);
  for (const Entry& entry : entries) ++offsets[entry.row + std::size_t{1}];
  for (std::size_t r = 0; r < shape.rows; ++r) offsets[r + 1] += offsets[r];
  std::vector<std::uint64_t> next(offsets.begin(), offsets.end() - 1);
  std::vector<std::uint32_t> ids(entries.size());
  for (const Entry& entry : entries) ids[next[entry.row]++] = entry.column;
  auto kept = ids.begin();
  auto begin = ids.begin();
  for (std::size_t r = 0; r < shape.rows; ++r) {
    const auto end = ids.begin() + static_cast<std::ptrdiff_t>(offsets[r + 1]);
    if (!std::is_sorted(begin, end)) std::sort(begin, end);
    const auto last = std::unique(begin, end);
    kept = kept == begin ? last : std::move(begin, last, kept);
    begin = end;
    offsets[r + 1] = static_cast<std::uint64_t>(kept - ids.begin());
  }
  repeated += static_cast<std::uint64_t>(ids.end() - kept);
  ids.erase(kept, ids.end());
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

VisibilityMatrix with_transpose(const VisibilityMatrix& half) {
  const VisibilityMatrix other = transpose(half);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{half.shape().rows} + 1);
  std::vector<std::uint32_t> ids;
  ids.reserve(half.ones() * 2);
  for (std::uint32_t r = 0; r < half.shape().rows; ++r) {
    const auto stored = half.row(r), implied = other.row(r);
    std::set_union(stored.begin(), stored.end(), implied.begin(), implied.end(), std::back_inserter(ids));
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(half.shape(), std::move(offsets), std::move(ids));
}

}  // namespace vismat
