// A dense bit matrix whose rows start on 64-bit words, for popcounts and Hamming distances.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// Bit c of row r is bit c % 64 of word c / 64 of the row; bits past the last column are zero. Takes
/// rows * ceil(columns / 64) * 8 bytes.
class BitRows {
 public:
  BitRows() = default;
  explicit BitRows(Shape shape);
  explicit BitRows(const VisibilityMatrix& matrix);

  Shape shape() const { return shape_; }
  std::size_t words_per_row() const { return words_per_row_; }
  std::span<const std::uint64_t> row(std::uint32_t r) const {
    return {words_.data() + r * words_per_row_, words_per_row_};
  }
  std::span<std::uint64_t> row(std::uint32_t r) {
    return {words_.data() + r * words_per_row_, words_per_row_};
  }
  bool get(std::uint32_t r, std::uint32_t c) const { return row(r)[c / 64] >> (c % 64) & 1; }
  void set(std::uint32_t r, std::uint32_t c) { row(r)[c / 64] |= std::uint64_t{1} << (c % 64); }
  std::uint64_t ones() const;
  VisibilityMatrix to_matrix() const;
  bool operator==(const BitRows&) const = default;

 private:
  Shape shape_;
  std::size_t words_per_row_ = 0;
  std::vector<std::uint64_t> words_;
};

/// The number of bits in which the spans differ, or some number above `limit` as soon as it is known to be above. Both
/// spans have the same length. Uses AVX-512 or POPCNT where the machine has them.
std::uint32_t hamming_distance(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                               std::uint32_t limit = 0xffffffff);

}  // namespace vismat
