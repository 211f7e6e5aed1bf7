// An order of a matrix's rows or columns, stored as a permutation.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace vismat {

/// A permutation of [0, size), checked once, on construction. new_of_old()[old] is where `old` moves to;
/// old_of_new()[place] is what stands at `place` afterwards.
class Permutation {
 public:
  Permutation() = default;
  static Permutation identity(std::uint32_t size);
  /// Both throw std::invalid_argument, naming the first bad number, if the map is not a bijection.
  static Permutation from_new_of_old(std::vector<std::uint32_t> map);
  static Permutation from_old_of_new(std::vector<std::uint32_t> map);  // a visiting order

  std::uint32_t size() const { return static_cast<std::uint32_t>(new_of_old_.size()); }
  std::span<const std::uint32_t> new_of_old() const { return new_of_old_; }
  std::vector<std::uint32_t> old_of_new() const;  // made anew at each call, O(size)
  Permutation inverse() const;
  bool is_identity() const;
  bool operator==(const Permutation&) const = default;

 private:
  std::vector<std::uint32_t> new_of_old_;
};

/// The fewest bytes that can tell one permutation of this size from all others: (log2 n!) / 8, rounded up.
std::uint64_t permutation_bytes(std::uint32_t size);

}  // namespace vismat
