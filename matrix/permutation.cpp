#include "matrix/permutation.h"

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismat {
namespace {

std::vector<std::uint32_t> inverted(std::span<const std::uint32_t> map) {
  constexpr std::uint32_t unset = 0xffffffff;
  std::vector<std::uint32_t> inverse(map.size(), unset);
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    if (map[i] >= map.size() || inverse[map[i]] != unset) {
      throw std::invalid_argument("not a permutation of " + std::to_string(map.size()) + " places: entry " +
                                  std::to_string(i) + " is " + std::to_string(map[i]) +
                                  (map[i] >= map.size() ? ", out of range" : ", a repeat"));
    }
    inverse[map[i]] = i;
  }
  return inverse;
}

}  // namespace

Permutation Permutation::identity(std::uint32_t size) {
  Permutation p;
  p.new_of_old_.resize(size);
  std::iota(p.new_of_old_.begin(), p.new_of_old_.end(), 0u);
  return p;
}

Permutation Permutation::from_new_of_old(std::vector<std::uint32_t> map) {
  inverted(map);  // for the check
  Permutation p;
  p.new_of_old_ = std::move(map);
  return p;
}

Permutation Permutation::from_old_of_new(std::vector<std::uint32_t> map) {
  Permutation p;
  p.new_of_old_ = inverted(map);
  return p;
}

std::vector<std::uint32_t> Permutation::old_of_new() const {
  return inverted(new_of_old_);
}

Permutation Permutation::inverse() const {
  Permutation p;
  p.new_of_old_ = inverted(new_of_old_);
  return p;
}

bool Permutation::is_identity() const {
  return *this == identity(size());
}

std::uint64_t permutation_bytes(std::uint32_t size) {
  return static_cast<std::uint64_t>(std::ceil(std::lgamma(size + 1.0) / std::log(2.0) / 8));
}

}  // namespace vismat
