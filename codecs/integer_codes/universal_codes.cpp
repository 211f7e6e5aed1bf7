#include "codecs/integer_codes/universal_codes.h"

namespace vismat {
namespace {

void put_gamma(ListWriter& out, std::uint32_t number) {
  const auto below = static_cast<unsigned>(std::bit_width(number)) - 1;
  if (below <= 27)
    return out.put(lowest_bits(number, below) << below << 1 | std::uint64_t{1} << below, 2 * below + 1);
  out.put(std::uint64_t{1} << below, below + 1);
  out.put(lowest_bits(number, below), below);
}

}  // namespace

void GammaCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  ListWriter bits(out);
  for (const std::uint32_t number : numbers) put_gamma(bits, number);
  bits.finish();
}

std::size_t GammaCode::Reader::read(std::span<std::uint32_t> out) {
  return bits_.read(out, [](ListBits& bits) {
    std::uint64_t ahead = bits.peek();
    const auto below = static_cast<unsigned>(std::countr_zero(ahead));
    if (below <= 28) [[likely]] {  // all of its bits are in sight
      bits.take(2 * below + 1);
      return std::uint32_t{1} << below | static_cast<std::uint32_t>(lowest_bits(ahead >> below >> 1, below));
    }
    if (below > 31) bits.fail("a number above 2^32 - 1");
    bits.take(below + 1);
    ahead = bits.peek();
    bits.take(below);
    return std::uint32_t{1} << below | static_cast<std::uint32_t>(lowest_bits(ahead, below));
  });
}

void DeltaCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  ListWriter bits(out);
  for (const std::uint32_t number : numbers) {
    const auto width = static_cast<unsigned>(std::bit_width(number));
    put_gamma(bits, width);
    bits.put(lowest_bits(number, width - 1), width - 1);
  }
  bits.finish();
}

std::size_t DeltaCode::Reader::read(std::span<std::uint32_t> out) {
  return bits_.read(out, [](ListBits& bits) {
    std::uint64_t ahead = bits.peek();
    const auto below_width = static_cast<unsigned>(std::countr_zero(ahead));
    if (below_width > 5) bits.fail("a number above 2^32 - 1");
    ahead >>= below_width + 1;
    const unsigned width = 1u << below_width | static_cast<unsigned>(lowest_bits(ahead, below_width));
    if (width > 32) bits.fail("a number above 2^32 - 1");
    bits.take(2 * below_width + width);
    return std::uint32_t{1} << (width - 1) |
           static_cast<std::uint32_t>(lowest_bits(ahead >> below_width, width - 1));
  });
}

}  // namespace vismat
