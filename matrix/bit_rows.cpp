#include "matrix/bit_rows.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace vismat {
namespace {

// The same loop for several instruction sets; the limit, if there is one, is looked at every 16 words, once the
// sum is out of the registers.
[[gnu::always_inline]] inline std::uint32_t distance_loop(const std::uint64_t* a, const std::uint64_t* b,
                                                          std::size_t words, std::uint32_t limit) {
  const std::size_t stretch = limit == 0xffffffff ? words : 16;
  std::uint64_t distance = 0;
  for (std::size_t i = 0; i < words && distance <= limit;) {
    const std::size_t end = std::min(words, i + stretch);
    for (; i < end; ++i) distance += static_cast<std::uint64_t>(std::popcount(a[i] ^ b[i]));
  }
  return static_cast<std::uint32_t>(distance);
}

std::uint32_t distance_plain(const std::uint64_t* a, const std::uint64_t* b, std::size_t words,
                             std::uint32_t limit) {
  return distance_loop(a, b, words, limit);
}
#if defined(__x86_64__)
[[gnu::target("popcnt")]] std::uint32_t distance_popcnt(const std::uint64_t* a, const std::uint64_t* b,
                                                        std::size_t words, std::uint32_t limit) {
  return distance_loop(a, b, words, limit);
}
[[gnu::target("avx512f,avx512vl,avx512vpopcntdq,popcnt")]] std::uint32_t distance_avx512(
    const std::uint64_t* a, const std::uint64_t* b, std::size_t words, std::uint32_t limit) {
  return distance_loop(a, b, words, limit);
}
#endif

const auto distance_of_words = [] {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512vpopcntdq") && __builtin_cpu_supports("avx512vl"))
    return &distance_avx512;
  if (__builtin_cpu_supports("popcnt")) return &distance_popcnt;
#endif
  return &distance_plain;
}();

}  // namespace

std::uint32_t hamming_distance(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                               std::uint32_t limit) {
  return distance_of_words(a.data(), b.data(), a.size(), limit);
}

BitRows::BitRows(Shape shape)
    : shape_(shape),
      words_per_row_((std::size_t{shape.columns} + 63) / 64),
      words_(shape.rows * words_per_row_, 0) {}

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
