#include "matrix/bit_rows.h"

#include <utility>

namespace vismat {

BitRows::BitRows(Shape shape)
    : shape_(shape), words_per_row_((std::size_t{shape.columns} + 63) / 64), words_(shape.rows * words_per_row_, 0) {}

BitRows::BitRows(const VisibilityMatrix& matrix) : BitRows(matrix.shape()) {
  for (std::uint32_t r = 0; r < shape_.rows; ++r) {
    const auto words = row(r);
    for (const std::uint32_t c : matrix.row(r)) words[c / 64] |= std::uint64_t{1} << (c % 64);
  }
}

std::uint64_t BitRows::ones() const {
  std::uint64_t ones = 0;
  for (const std::uint64_t word : words_) ones += static_cast<std::uint64_t>(std::popcount(word));
  return ones;
}

VisibilityMatrix BitRows::to_matrix() const {
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{shape_.rows} + 1);
  std::vector<std::uint32_t> ids;
  ids.reserve(ones());
  for (std::uint32_t r = 0; r < shape_.rows; ++r) {
    const auto words = row(r);
    for (std::size_t w = 0; w < words.size(); ++w) {
      for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1) {
        ids.push_back(static_cast<std::uint32_t>(w * 64 + static_cast<std::size_t>(std::countr_zero(rest))));
      }
    }
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(shape_, std::move(offsets), std::move(ids));
}

}  // namespace vismat
