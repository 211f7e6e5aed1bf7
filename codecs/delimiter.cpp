// ALGORITHM. Why the code can be read, and how it is read 50 bits at a time.
//
// The code of a number begins with one or two ones and a 0, or is 11 as a whole (the number 1). It ends in 0 or in 011, for
// a last 1 that closes no pair stands behind a 0, of the number or put there, and gets one more 1. Inside, no more than
// two ones stand together, and a 0 follows two. So ones stand together by three or more only around delimiters:
//
//     ...0 [11] 11 [11 11]... 1[1] 0...      t + 2 + 4 k + l ones
//      tail t   delimiter     head l         t = 0 or 2, then k numbers 1 with their delimiters, l = 1 or 2
//
// length - 3 = t + 4 k + (l - 1): its remainder by 4 tells t and l, its quotient k. At the list's start the ones number
// 4 k + l, at its end t + 4 k, and 4 k - 2 if there are but ones. Hence one parse at most; and a list that is read in this way,
// of numbers below 2^32, is written in this way. As printed, rule 3 leaves the number 1 as it is: then (5, 3) and
// (2, 1, 2) are both 101111110. The paper's decoder relies on the reading taken here ("all instances of 1 get replaced by
// 11"). The tests prove both, for all lengths, on the automaton of the rules.
//
// How long a code gets. Of n bits p pairs get a 0, and e = 1 or 0 last ones get one more; these are apart, 2 p + e <= n,
// so p + e <= (n + e) / 2, rounded down at most (n + 1) / 2. A number of n ones takes that.
//
// Decoding. A window of the list begins with the delimiter before a number; before the first number two ones are made up,
// and behind the last one the end's 1 becomes 1110, a delimiter and a number that nobody reads. Where ones stand
// together by three or more and end in the window, arithmetic on the whole word finds whether they are odd in number (a
// subtraction carries through all of them at once, as in simdjson's escapes [Langdale, Lemire 2019]), hence l, hence where
// the number behind them starts; the numbers 1 start every fourth place before, as far as the ones reach. Each code between
// two starts is then a table's index; codes of more than 11 bits (numbers from 128 on at the earliest) take longer. A
// number whose end the window does not show is read alone.
//
// The tables take 8 kB (decoding) and 4 kB.
#include "codecs/delimiter.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

#include "matrix/byte_reader.h"

namespace vismat {

namespace {

using u64 = std::uint64_t;

constexpr u64 low_bits(unsigned count) {  // count < 64
  return (u64{1} << count) - 1;
}

struct Code {
  u64 bits;  // the first one lowest
  unsigned length;
};

constexpr u64 reversed(u64 bits) {
  const auto swap = [&bits](unsigned by, u64 mask) { bits = (bits >> by & mask) | (bits & mask) << by; };
  swap(1, 0x5555555555555555);
  swap(2, 0x3333333333333333);
  swap(4, 0x0f0f0f0f0f0f0f0f);
  swap(8, 0x00ff00ff00ff00ff);
  swap(16, 0x0000ffff0000ffff);
  return bits >> 32 | bits << 32;
}

// Of ones that stand together the first, the third and so on, and the place behind if they are odd in number.
constexpr u64 every_other(u64 ones) {
  constexpr u64 odd_places = 0xaaaaaaaaaaaaaaaa;
  return ((ones << 1 | odd_places) - ones) ^ odd_places;
}

constexpr Code code_of(std::uint32_t number) {
  auto length = static_cast<unsigned>(std::bit_width(number));
  u64 bits = reversed(number) >> (64 - length);
  const u64 opens = every_other(bits);
  u64 closes = bits & ~opens;                           // the second ones of pairs
  const u64 unpaired = (bits & opens) >> (length - 1);  // 1 where the last one closes no pair
  bits |= unpaired << length;
  length += static_cast<unsigned>(unpaired);
  for (; closes != 0; closes = (closes & (closes - 1)) << 1) {
    const u64 upto = closes ^ (closes - 1);
    bits = (bits & upto) | (bits & ~upto) << 1;
    ++length;
  }
  return {bits, length};
}

constexpr Code with_delimiter(Code code) {
  return {code.bits | u64{3} << code.length, code.length + 2};
}

// The codes of small numbers, each with the delimiter behind it: bits below 2^24, length above.
constexpr std::uint32_t small_numbers = 1024;
constexpr auto code_of_small = [] {
  std::array<std::uint32_t, small_numbers> table{};
  for (std::uint32_t number = 1; number < small_numbers; ++number) {
    const Code code = with_delimiter(code_of(number));
    table[number] = static_cast<std::uint32_t>(code.bits) | code.length << 24;
  }
  return table;
}();

// The number of each code of up to 11 bits, at 2^length + bits.
constexpr unsigned small_length = 11;
constexpr auto number_of_small = [] {
  std::array<std::uint16_t, std::size_t{1} << (small_length + 1)> table{};
  for (std::uint32_t number = 1; number < 1u << small_length; ++number) {
    const Code code = code_of(number);
    if (code.length <= small_length)
      table[u64{1} << code.length | code.bits] = static_cast<std::uint16_t>(number);
  }
  return table;
}();

constexpr const char* too_large = "a number above 2^32 - 1";
[[noreturn]] void fail(std::int64_t place, const char* what) {
  throw FormatError("delimiter code, bit " + std::to_string(place) + ": " + what);
}

// Of a code of 2 to 63 bits, `place` bits into the list.
std::uint32_t number_of_code(Code code, std::int64_t place) {
  if (code.length > longest_delimited(32)) fail(place, too_large);
  if (code.bits >> (code.length - 2) == 3) {  // what ends in 01 got one more 1
    --code.length;
    code.bits &= low_bits(code.length);
  }
  // Two ones stand together only where a 0 was put behind them.
  for (u64 put = ~code.bits & code.bits << 1 & code.bits << 2; put != 0;) {
    const u64 below = (put & -put) - 1;
    code.bits = (code.bits & below) | (code.bits >> 1 & ~below);
    --code.length;
    put = (put & (put - 1)) >> 1;
  }
  if (code.length > 32) fail(place, too_large);
  return static_cast<std::uint32_t>(reversed(code.bits) >> (64 - code.length));
}

// Where at least two ones stand before a one.
constexpr u64 third_ones(u64 ones) {
  return ones & ones << 1 & ones << 2;
}

constexpr int window_bits = 57;  // a load of 64, shifted by up to 7

struct Window {
  u64 ones;            // from `place` on: a delimiter, then a number
  u64 ends;            // the places, as bits, where its next numbers start
  std::int64_t place;  // in the list
};

inline std::uint32_t* put_numbers(const Window& window, std::uint32_t* to) {
  unsigned start = 2;
  for (u64 ends = window.ends; ends != 0; ends &= ends - 1) {
    const auto end = static_cast<unsigned>(std::countr_zero(ends));
    const unsigned length = end - start - 2;
    const u64 bits = window.ones >> start & low_bits(length);
    *to++ = length <= small_length ? number_of_small[u64{1} << length | bits]
                                   : number_of_code({bits, length}, window.place + start);
    start = end;
  }
  return to;
}

}  // namespace

void put_delimited(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  constexpr std::size_t block = 64;
  std::array<std::byte, block*(longest_delimited(32) + 2) / 8 + 8> bytes;
  u64 pending = 0;
  unsigned held = 0;
  while (!numbers.empty()) {
    const auto now = numbers.first(std::min(block, numbers.size()));
    numbers = numbers.subspan(now.size());
    std::byte* to = bytes.data();
    for (const std::uint32_t number : now) {
      assert(number >= 1);
      const Code code = number < small_numbers
                            ? Code{code_of_small[number] & 0xffffff, code_of_small[number] >> 24}
                            : with_delimiter(code_of(number));
      pending |= code.bits << held;
      held += code.length;
      std::memcpy(to, &pending, 8);
      to += held / 8;
      pending >>= held & ~7u;
      held %= 8;
    }
    out.insert(out.end(), bytes.data(), to);
  }
  if (held > 0) out.push_back(static_cast<std::byte>(pending));
  // Of the delimiter behind the last number one 1 stays, the list's end.
  const auto last = std::to_integer<unsigned>(out.back());
  out.back() = static_cast<std::byte>(last ^ std::bit_floor(last));
  if (last == 1) out.pop_back();
}

DelimitedReader::DelimitedReader(std::span<const std::byte> bytes)
    : bytes_(bytes.data()), tail_begin_(0), next_(0), stop_(0) {
  if (bytes.empty()) return;
  const auto last = std::to_integer<unsigned>(bytes.back());
  if (last == 0)
    throw FormatError("delimiter code: its last byte, " + std::to_string(bytes.size() - 1) + ", is zero");
  const auto size = static_cast<std::int64_t>(bytes.size());
  tail_begin_ = std::max<std::int64_t>(0, size - 8);
  next_ = -2;
  stop_ = 8 * size - 9 + std::bit_width(last);
  std::memcpy(tail_.data(), bytes.data() + tail_begin_, static_cast<std::size_t>(size - tail_begin_));
  for (const std::int64_t place : {stop_ + 1, stop_ + 2})
    tail_[static_cast<std::size_t>(place / 8 - tail_begin_)] |= static_cast<std::byte>(1u << place % 8);
}

// The list's bits from `place` on, inverted: at least `window_bits`, zeros above.
inline u64 DelimitedReader::zeros_from(std::int64_t place) const {
  const auto load = [this](std::int64_t byte) {
    u64 bits;
    std::memcpy(&bits, byte < tail_begin_ ? bytes_ + byte : tail_.data() + (byte - tail_begin_), 8);
    return ~bits;
  };
  return place < 0 ? load(0) << -place : load(place / 8) >> place % 8;
}

// The number behind the delimiter at next_, whatever follows it.
DelimitedReader::Found DelimitedReader::read_alone() const {
  const std::int64_t begin = next_ + 2;
  const u64 zeros = zeros_from(next_), ones = ~zeros;
  const int head = std::countr_zero(zeros) - 2;
  if (head == 0) fail(begin, "a number that begins with 0");
  if (head >= 5) return {1, next_ + 4};
  if (head >= 3 || begin > stop_) fail(begin, "ones of no count that numbers make");
  const u64 third = third_ones(ones) & ~low_bits(4);
  if (third == 0) fail(begin, too_large);
  const std::int64_t run = next_ + std::countr_zero(third) - 2;
  std::int64_t run_end = run;
  u64 zeros_there = zeros_from(run_end);
  for (; zeros_there == 0; zeros_there = zeros_from(run_end)) run_end += window_bits;
  run_end += std::countr_zero(zeros_there);
  const std::int64_t end = run + ((run_end - run - 3) & 2);
  const auto length = static_cast<unsigned>(end - begin);
  if (length > longest_delimited(32)) fail(begin, too_large);
  return {number_of_code({ones >> 2 & low_bits(length), length}, begin), end};
}

std::size_t DelimitedReader::read(std::span<std::uint32_t> out) {
  assert(out.size() >= least_room);
  constexpr std::ptrdiff_t most_in_window = 16;
  std::uint32_t* to = out.data();
  std::uint32_t* const limit = to + out.size() - 2 * most_in_window;
  // A window's numbers are written when the next window's are found: how many there are is hard to foresee for the
  // processor, and thus it has something to do meanwhile.
  Window found{};
  while (to <= limit && next_ < stop_) {
    const u64 zeros = zeros_from(next_), ones = ~zeros;
    const u64 third = third_ones(ones);
    const u64 behind = zeros & third << 1;  // of three or more ones
    const u64 behind_odd = behind & every_other(ones);
    const u64 heads = behind_odd >> 1 | (behind ^ behind_odd) >> 2;
    u64 linked = third & third >> 3 & third >> 4;  // a number 1 may start here if a number starts 4 places on
    u64 starts = heads | (heads >> 4 & linked);
    linked &= linked >> 4;
    starts |= starts >> 8 & linked;
    linked &= linked >> 8;
    starts |= starts >> 16 & linked;
    linked &= linked >> 16;
    starts |= starts >> 32 & linked;
    to = put_numbers(found, to);
    found = {ones, starts & ~u64{4}, next_};
    if (found.ends != 0 && found.ends != starts) [[likely]] {
      next_ += 61 - std::countl_zero(heads);
    } else {
      found.ends = 0;
      if (zeros << 13 == 0) {
        to = std::fill_n(to, 12, 1u);
        next_ += 48;
      } else {
        const Found alone = read_alone();
        *to++ = alone.number;
        next_ = alone.next;
      }
    }
  }
  to = put_numbers(found, to);
  return static_cast<std::size_t>(to - out.data());
}

}  // namespace vismat
