// Steps that visit each number of a range once: the code for orders and for the objects of trees.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "codecs/entropy/adaptive_coder.h"

namespace vismat {

/// Throws FormatError if so few bytes cannot back so large a claim. Adaptive coders store at least 1/180 of a bit for
/// each bit that they read, so a byte backs 1440 bits at most; 2^22 are accepted without backing.
inline void check_backed(std::uint64_t claimed, std::uint64_t bytes, const char* what) {
  if (claimed > (std::uint64_t{1} << 22) + 2048 * bytes)
    throw FormatError(std::to_string(claimed) + " " + what + " in " + std::to_string(bytes) + " bytes");
}

/// The numbers [0, size), at first all unvisited. code() codes the next number by the count of unvisited numbers
/// between it and the last one, and by the direction. O(log size) for each step; 4 bytes for each number.
class Steps {
 public:
  explicit Steps(std::uint32_t size) : left_(size), unvisited_(std::size_t{size} + 1) {
    for (std::size_t i = 1; i < unvisited_.size(); ++i) unvisited_[i] = static_cast<std::uint32_t>(i & -i);
  }
  std::uint32_t left() const { return left_; }

  /// A writer's `next` must be unvisited. left() must be above 0.
  template <typename Coder>
  std::uint32_t code(Coder& coder, std::uint32_t next) {
    const std::uint32_t rank = Coder::reads ? 0 : below(next);
    const bool both = here_ > 0 && here_ < left_;
    const bool up = both ? coder.bit(up_[last_up_][last_far_ > 0], rank >= here_) : here_ == 0;
    const std::uint32_t most = up ? left_ - here_ : here_;  // unvisited on that side
    AdaptiveNumber& numbers = between_[both ? 1 + (up == ((last_up_ & 1) != 0)) : 0][last_far_];
    const std::uint32_t between = numbers.code(coder, up ? rank - here_ : here_ - 1 - rank);
    if (between >= most) throw FormatError("a step beyond the last number");
    const std::uint32_t taken = up ? here_ + between : here_ - 1 - between;
    last_up_ = (last_up_ << 1 | unsigned{up}) & 3;
    last_far_ = std::min(static_cast<unsigned>(std::bit_width(between)), 5u);
    here_ = taken;
    return take(taken);
  }

 private:
  // The count of unvisited numbers below this one.
  std::uint32_t below(std::uint32_t number) const {
    std::uint32_t count = 0;
    for (std::size_t i = number; i > 0; i &= i - 1) count += unvisited_[i];
    return count;
  }
  // The unvisited number of this rank, which is visited from now on.
  std::uint32_t take(std::uint32_t rank) {
    std::size_t at = 0;
    for (std::size_t step = std::bit_floor(unvisited_.size() - 1); step > 0; step /= 2) {
      if (at + step < unvisited_.size() && unvisited_[at + step] <= rank) {
        at += step;
        rank -= unvisited_[at];
      }
    }
    for (std::size_t i = at + 1; i < unvisited_.size(); i += i & -i) --unvisited_[i];
    --left_;
    return static_cast<std::uint32_t>(at);
  }

  std::uint32_t left_, here_ = 0;  // unvisited in all; below the last number
  unsigned last_up_ = 3, last_far_ = 0;
  std::array<std::array<AdaptiveBit, 2>, 4> up_;
  std::array<std::array<AdaptiveNumber, 6>, 3> between_;
  std::vector<std::uint32_t> unvisited_;  // a Fenwick tree
};

}  // namespace vismat
