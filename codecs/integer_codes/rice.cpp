#include "codecs/integer_codes/rice.h"

#include <utility>

namespace vismat {
namespace {

constexpr unsigned parameters = 16;
constexpr std::uint32_t most_zeros = 24;

// The bits that every second number from `first` on takes.
std::uint64_t cost(std::span<const std::uint32_t> numbers, std::size_t first, unsigned parameter) {
  std::uint64_t bits = 0;
  for (std::size_t i = first; i < numbers.size(); i += 2) {
    const std::uint32_t quotient = (numbers[i] - 1) >> parameter;
    bits += quotient < most_zeros ? quotient + 1 + parameter : most_zeros + 32;
  }
  return bits;
}

unsigned best_parameter(std::span<const std::uint32_t> numbers, std::size_t first) {
  unsigned best = 0;
  std::uint64_t least = ~std::uint64_t{0};
  for (unsigned k = 0; k < parameters; ++k) {
    const std::uint64_t bits = cost(numbers, first, k);
    if (bits < least) least = bits, best = k;
  }
  return best;
}

}  // namespace

void RiceCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  const std::array<unsigned, 2> chosen = {best_parameter(numbers, 0), best_parameter(numbers, 1)};
  out.push_back(static_cast<std::byte>(chosen[0] | chosen[1] << 4));
  ListWriter bits(out);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const unsigned k = chosen[i % 2];
    const std::uint32_t below = numbers[i] - 1, quotient = below >> k;
    if (quotient < most_zeros) {
      bits.put((lowest_bits(below, k) << 1 | 1) << quotient, quotient + 1 + k);
    } else {
      bits.put(std::uint64_t{numbers[i]} << most_zeros, most_zeros + 32);
    }
  }
  bits.finish();
}

RiceCode::Reader::Reader(const RiceCode&, std::span<const std::byte> bytes)
    : bits_(bytes.subspan(bytes.empty() ? 0 : 1), "Rice code", 1), parameters_{} {
  if (bytes.empty()) return;
  if (bytes.size() == 1) bits_.fail("parameters without a list");
  const auto both = std::to_integer<unsigned>(bytes[0]);
  parameters_ = {both & 15, both >> 4};
}

std::size_t RiceCode::Reader::read(std::span<std::uint32_t> out) {
  unsigned k = parameters_[0], other = parameters_[1];
  const std::size_t count = bits_.read(out, [&](ListBits& bits) {
    const std::uint64_t ahead = bits.peek();
    const auto quotient = static_cast<unsigned>(std::countr_zero(ahead));
    const unsigned now = std::exchange(k, other);
    other = now;
    if (quotient < most_zeros) [[likely]] {
      bits.take(quotient + 1 + now);
      return (quotient << now) + static_cast<std::uint32_t>(lowest_bits(ahead >> quotient >> 1, now)) + 1;
    }
    const auto number = static_cast<std::uint32_t>(ahead >> most_zeros);
    if (number == 0 || (number - 1) >> now < most_zeros)
      bits.fail("a long form of a number that has a short one");
    bits.take(most_zeros + 32);
    return number;
  });
  parameters_ = {k, other};
  return count;
}

}  // namespace vismat
