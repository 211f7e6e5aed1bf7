#include "matrix/visibility_matrix.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>
#include <utility>

#include "matrix/permutation.h"

namespace vismat {

VisibilityMatrix::VisibilityMatrix(Shape shape) : shape_(shape), offsets_(std::size_t{shape.rows} + 1, 0) {}

VisibilityMatrix VisibilityMatrix::from_csr(Shape shape, std::vector<std::uint64_t> offsets,
                                            std::vector<std::uint32_t> ids) {
  const auto refuse = [](const std::string& what) -> void { throw std::invalid_argument(what); };
  if (offsets.size() != std::size_t{shape.rows} + 1) {
    refuse(std::to_string(offsets.size()) + " row offsets for " + std::to_string(shape.rows) +
           " rows; need " + std::to_string(std::size_t{shape.rows} + 1));
  }
  if (offsets.front() != 0)
    refuse("the first row offset is " + std::to_string(offsets.front()) + "; it must be 0");
  if (offsets.back() != ids.size()) {
    refuse("the last row offset is " + std::to_string(offsets.back()) + " but there are " +
           std::to_string(ids.size()) + " ids");
  }
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    if (offsets[r + 1] < offsets[r] || offsets[r + 1] > ids.size()) {
      refuse("row " + std::to_string(r) + ": its offset " + std::to_string(offsets[r + 1]) +
             " does not ascend");
    }
    std::uint64_t least = 0;  // the smallest id that may come next
    for (std::uint64_t i = offsets[r]; i < offsets[r + 1]; ++i) {
      if (ids[i] < least) {
        refuse("row " + std::to_string(r) + ": id " + std::to_string(ids[i]) + " does not ascend");
      }
      least = std::uint64_t{ids[i]} + 1;
    }
    if (least > shape.columns) {
      refuse("row " + std::to_string(r) + ": id " + std::to_string(least - 1) + " but only " +
             std::to_string(shape.columns) + " columns");
    }
  }
  VisibilityMatrix matrix;
  matrix.shape_ = shape;
  matrix.offsets_ = std::move(offsets);
  matrix.ids_ = std::move(ids);
  return matrix;
}

VisibilityMatrix VisibilityMatrix::from_rows(const std::vector<std::vector<std::uint32_t>>& rows,
                                             std::uint32_t columns) {
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(rows.size() + 1);
  for (const auto& row : rows) offsets.push_back(offsets.back() + row.size());
  std::vector<std::uint32_t> ids;
  ids.reserve(offsets.back());
  for (const auto& row : rows) ids.insert(ids.end(), row.begin(), row.end());
  return from_csr({static_cast<std::uint32_t>(rows.size()), columns}, std::move(offsets), std::move(ids));
}

double VisibilityMatrix::density() const {
  const double table = static_cast<double>(shape_.rows) * shape_.columns;
  return table == 0 ? 0 : static_cast<double>(ones()) / table;
}

bool VisibilityMatrix::contains(std::uint32_t r, std::uint32_t column) const {
  const auto ids = row(r);
  return std::binary_search(ids.begin(), ids.end(), column);
}

VisibilityMatrix transpose(const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  std::vector<std::uint64_t> offsets(std::size_t{shape.columns} + 1, 0);
  for (const std::uint32_t c : matrix.ids()) ++offsets[std::size_t{c} + 1];
  for (std::size_t c = 0; c < shape.columns; ++c) offsets[c + 1] += offsets[c];
  std::vector<std::uint32_t> ids(matrix.ones());
  std::vector<std::uint64_t> next(offsets.begin(), offsets.end() - 1);
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    for (const std::uint32_t c : matrix.row(r)) ids[next[c]++] = r;
  }
  return VisibilityMatrix::from_csr({shape.columns, shape.rows}, std::move(offsets), std::move(ids));
}

VisibilityMatrix permute(VisibilityMatrix matrix, const Permutation& rows, const Permutation& columns) {
  const Shape shape = matrix.shape();
  assert(rows.size() == shape.rows && columns.size() == shape.columns);
  if (!columns.is_identity()) {
    const auto new_columns = columns.new_of_old();
    for (std::uint32_t r = 0; r < shape.rows; ++r) {
      const std::span ids(matrix.ids_.data() + matrix.offsets_[r],
                          matrix.ids_.data() + matrix.offsets_[r + 1]);
      for (std::uint32_t& id : ids) id = new_columns[id];
      std::sort(ids.begin(), ids.end());
    }
  }
  if (rows.is_identity()) return matrix;
  VisibilityMatrix result(shape);
  result.ids_.reserve(matrix.ones());
  std::uint32_t place = 0;
  for (const std::uint32_t old : rows.old_of_new()) {
    const auto ids = matrix.row(old);
    result.ids_.insert(result.ids_.end(), ids.begin(), ids.end());
    result.offsets_[++place] = result.ids_.size();
  }
  return result;
}

}  // namespace vismat
