#include "codecs/integer_codes/interpolative.h"

#include <cassert>

#include "codecs/entropy/bit_stream.h"

namespace vismat {
namespace {

constexpr const char* name = "interpolative code";
constexpr std::uint64_t largest_sum = std::uint64_t{1} << 56;

// The code of one of `range` values: those below `shorter` take `bits` bits, others one more.
struct Choice {
  explicit Choice(std::uint64_t range)
      : bits(range == 1 ? 0 : static_cast<unsigned>(std::bit_width(range - 1)) - 1),
        shorter(range == 1 ? 1 : (std::uint64_t{2} << bits) - range) {}
  unsigned bits;
  std::uint64_t shorter;
};

void put_choice(ListWriter& out, std::uint64_t value, std::uint64_t range) {
  const Choice choice(range);
  if (value < choice.shorter) return out.put(value, choice.bits);
  value += choice.shorter;
  out.put(value >> 1 | (value & 1) << choice.bits, choice.bits + 1);
}

std::uint64_t get_choice(ListBits& in, std::uint64_t range) {
  const Choice choice(range);
  if (choice.bits == 0 && choice.shorter == 1) return 0;
  const std::uint64_t ahead = in.peek(), value = lowest_bits(ahead, choice.bits);
  in.take(choice.bits);
  if (value < choice.shorter) return value;
  in.take(1);
  return value * 2 + (ahead >> choice.bits & 1) - choice.shorter;
}

}  // namespace

void InterpolativeCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  sums_.assign(1, 0);
  for (const std::uint32_t number : numbers) sums_.push_back(sums_.back() + number);
  assert(sums_.back() <= largest_sum);
  put_varint(out, numbers.size());
  put_varint(out, sums_.back() - numbers.size());
  ListWriter bits(out);
  const auto open = [&](const auto& self, std::size_t a, std::size_t b) -> void {
    if (b - a <= 1) return;
    const std::size_t m = a + (b - a) / 2;
    put_choice(bits, sums_[m] - sums_[a] - (m - a), sums_[b] - sums_[a] - (b - a) + 1);
    self(self, a, m);
    self(self, m, b);
  };
  open(open, 0, numbers.size());
  bits.finish();
}

InterpolativeCode::Reader::Reader(const InterpolativeCode&, std::span<const std::byte> bytes)
    : bits_({}, name, 0) {
  if (bytes.empty()) return;
  ByteReader in(bytes, name);
  const std::uint64_t count = in.varint();
  if (count == 0 || count > 0xffffffff) in.fail("a list of " + std::to_string(count) + " numbers");
  const std::uint64_t rest = in.varint();
  if (rest > largest_sum - count) in.fail("numbers that sum up to more than 2^56");
  if (in.left() == 0) in.fail("no list");
  bits_ = ListBits(bytes.subspan(in.offset()), name, 0);
  ahead_[height_++] = {static_cast<std::uint32_t>(count), rest + count};
}

std::size_t InterpolativeCode::Reader::read(std::span<std::uint32_t> out) {
  std::size_t count = 0;
  for (; count < out.size() && height_ > 0; ++count) {
    Known next = ahead_[height_ - 1];
    while (next.place - last_.place > 1) {
      const std::uint32_t half = (next.place - last_.place) / 2;
      const std::uint64_t range = next.sum - last_.sum - (next.place - last_.place) + 1;
      next = {last_.place + half, last_.sum + half + get_choice(bits_, range)};
      bits_.check();
      ahead_[height_++] = next;
    }
    const std::uint64_t number = next.sum - last_.sum;
    if (number > 0xffffffff) bits_.fail("a number above 2^32 - 1");
    out[count] = static_cast<std::uint32_t>(number);
    last_ = next;
    --height_;
  }
  if (height_ == 0 && !bits_.ended()) bits_.fail("bits behind the last number");
  return count;
}

}  // namespace vismat
