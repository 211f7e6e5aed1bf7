// ALGORITHM. The delimiter code: why it can be decoded, and how 50 bits are decoded at a time.
//
// The code of a number begins with one or two ones and a 0, or is 11 as a whole (the number 1). It ends in 0 or in 011,
// for a last 1 that closes no pair follows a 0, of the number or inserted, and gets one more 1. Inside, at most two
// ones follow one another, and a 0 follows two. So three or more ones in a row occur only around delimiters:
//
//     ...0 [11] 11 [11 11]... 1[1] 0...      t + 2 + 4 k + l ones
//      tail t   delimiter     head l         t = 0 or 2, then k numbers 1 with their delimiters, l = 1 or 2
//
// length - 3 = t + 4 k + (l - 1): its remainder by 4 gives t and l, its quotient k. At the list's start there are 4 k +
// l ones, at its end t + 4 k, and 4 k - 2 if there are only ones. So there is at most one parse, and a list that is
// read in this way, of numbers below 2^32, is written in this way. As printed, rule 3 leaves the number 1 as it is:
// then (5, 3) and (2, 1, 2) are both 101111110. The paper's decoder relies on the interpretation taken here ("all
// instances of 1 get replaced by 11"). The tests prove both, for all lengths, on the automaton of the rules.
//
// The length of a code. Of n bits p pairs get a 0, and e = 1 or 0 last ones get one more. These do not overlap, so 2 p
// + e <= n, and p + e <= (n + e) / 2, rounded down at most (n + 1) / 2. A number of n ones takes that many.
//
// Decoding. A window of the list begins with the delimiter before a number. Before the first number two ones are made
// up, and behind the last one the end's 1 becomes 1110, a delimiter and a number that is never read. Where three or
// more ones follow one another and end in the window, arithmetic on the whole word finds whether their number is odd (a
// subtraction carries through all of them at once, as simdjson finds escaped characters [Langdale, Lemire 2019]). This
// gives l, and so the start of the number behind them; numbers 1 start at every fourth place before, as far as the ones
// reach. The starts show every bit that the rules inserted. Then either
//   - pext removes these from the whole window, which in reverse holds the numbers' binary digits one behind the other, and
//     two shifts extract each number; or,
//   - without a fast pext, each code of up to 11 bits is an index of a table, and longer ones lose their bits one by one.
// Ones whose end is outside the window are counted through.
//
// The tables take 8 kB (decoding) and 4 kB.
//
// The limit (bench delimiter-speed, gaps and runs, 750 bytes or 1100 numbers; Zen 5 at 3.8 GHz, GCC 12). 750 bytes are
// read and 4.4 kB written: 0.15 us of stores, and 0.45 us if the bytes are not in the cache. But a window is found from
// the last start in the one before: 30 cycles for each of 115 windows, 0.9 us. We take 1.7 us, 6 cycles for each
// number. With the table we take 1.45 us on a list that the branch predictor has learnt and 2.4 us on others, about 1
// us of which is mispredicted branches. A decoder that also checks the numbers takes 1.85 us (learnt), 2.15 us and 2.7
// us (cold), the paper's pass bit by bit 18 us. The least gain is 2.2 times, where 30 numbers 1 and a larger one
// alternate: the plain pass predicts every bit of that.
//
// Tried and found worse: windows one after the other, +25 %; a loop over the numbers of an extracted window instead of
// always twelve, +25 %; always twelve with the table, +15 %; the table with BMI's instructions, nothing.
#include "codecs/integer_codes/delimiter.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

#include "matrix/base/byte_reader.h"

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

// Of each group of ones in a row the first, the third and so on, and the place behind the group if their number is odd.
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

[[noreturn]] void fail(std::int64_t place, const char* what) {
  throw FormatError("delimiter code, bit " + std::to_string(place) + ": " + what);
}

// The number of a code of 2 to 63 bits. A number of more than 32 bits gives some number of more than 32 bits.
u64 number_of_code(Code code) {
  if (code.bits >> (code.length - 2) == 3) {  // what ends in 01 got one more 1
    --code.length;
    code.bits &= low_bits(code.length);
  }
  // Two ones follow one another only where a 0 was inserted behind them.
  for (u64 put = ~code.bits & code.bits << 1 & code.bits << 2; put != 0; put = (put & (put - 1)) >> 1) {
    const u64 below = (put & -put) - 1;
    code.bits = (code.bits & below) | (code.bits >> 1 & ~below);
    --code.length;
  }
  return reversed(code.bits) >> (64 - code.length);
}

constexpr int window_bits = 57;  // a load of 64, shifted by up to 7
constexpr std::ptrdiff_t most_in_window = 15;

// Where numbers start in a window, which begins with a delimiter.
struct Starts {
  u64 zeros, ones;  // the window
  u64 behind_odd;   // the zeros behind an odd number of ones, three at least
  u64 heads;        // starts of numbers but 1
  u64 all;
};

inline Starts starts_in(u64 zeros) {
  const u64 ones = ~zeros;
  const u64 third = ones & ones << 1 & ones << 2;
  const u64 behind = zeros & third << 1;
  const u64 behind_odd = behind & every_other(ones);
  const u64 heads = behind_odd >> 1 | (behind ^ behind_odd) >> 2;
  // A number 1 starts four places before another number, where ones reach from its delimiter to that number.
  u64 linked = third & third >> 3 & third >> 4;
  u64 all = heads | (heads >> 4 & linked);
  linked &= linked >> 4;
  all |= all >> 8 & linked;
  linked &= linked >> 8;
  all |= all >> 16 & linked;
  linked &= linked >> 16;
  all |= all >> 32 & linked;
  return {zeros, ones, behind_odd, heads, all};
}

// The numbers of all codes but the last that begins in a window, each by a look into the table.
struct NumbersByTable {
  u64 ones = 0;
  u64 ends = 0;  // where the number behind starts
  std::int64_t place = 0;
  static NumbersByTable of(const Starts& starts, std::int64_t place) {
    return {starts.ones, starts.all & ~u64{4}, place};
  }
  // Writes them behind `to` and moves it on; false where one is above 2^32 - 1.
  bool write(std::uint32_t*& to) const {
    unsigned start = 2;
    u64 long_numbers = 0;
    for (u64 left = ends; left != 0; left &= left - 1) {
      const auto end = static_cast<unsigned>(std::countr_zero(left));
      const unsigned length = end - start - 2;
      const u64 bits = ones >> start & low_bits(length);
      if (length <= small_length) [[likely]] {
        *to++ = number_of_small[u64{1} << length | bits];
      } else {
        const u64 number = number_of_code({bits, length});
        long_numbers |= number;
        *to++ = static_cast<std::uint32_t>(number);
      }
      start = end;
    }
    return long_numbers >> 32 == 0;
  }
};

#if defined(__x86_64__)
// The bits of `from` at the ones of `mask`, moved together. Written as the instruction, since the intrinsic function may only
// be used in functions compiled for BMI2.
inline u64 extracted(u64 from, u64 mask) {
  u64 bits;
  __asm__("pext %2, %1, %0" : "=r"(bits) : "r"(from), "r"(mask));
  return bits;
}

// The same by extraction of the numbers' own bits from the whole window. The rest are shifts, without a branch that
// depends on a number.
struct NumbersByExtraction {
  u64 digits = 0;  // from the highest bit on
  u64 ends = 0;    // of each number in `digits`, counted from there
  u64 count = 0;
  std::int64_t place = 0;
  static NumbersByExtraction of(const Starts& starts, std::int64_t place) {
    const u64 second = starts.ones & starts.ones << 1;
    const u64 put_by_rule_2 = starts.zeros & second << 1 & ~starts.behind_odd;
    const u64 put_by_rule_3 = starts.all >> 3 & second;
    const u64 delimiters = starts.all >> 1 | starts.all >> 2;
    const u64 last = std::bit_floor(starts.heads);
    const u64 kept = ~(put_by_rule_2 | put_by_rule_3 | delimiters) & (2 * last - 1);
    const u64 ends = starts.all & ~u64{4};
    u64 nibbles = ends | ends >> 1;  // starts are four places apart: at most one in a nibble
    nibbles = (nibbles | nibbles >> 2) & 0x1111111111111111;
    return {reversed(extracted(starts.ones & (last - 1), kept)), extracted(ends, kept),
            nibbles * 0x1111111111111111 >> 60, place};
  }
  bool write(std::uint32_t*& to) const {
    u64 left = ends, all = 0;
    unsigned start = 0;
    const auto write_one = [&](std::ptrdiff_t i) {  // behind the last one: 0
      const auto end = static_cast<unsigned>(std::countr_zero(left | u64{1} << 63));
      left &= left - 1;
      const u64 number = digits << start >> ((start - end) % 64);
      all |= number;
      to[i] = static_cast<std::uint32_t>(number);
      start = end;
    };
    constexpr std::ptrdiff_t common = 12;
    for (std::ptrdiff_t i = 0; i < common; ++i) write_one(i);
    if (left != 0) [[unlikely]] {
      for (std::ptrdiff_t i = common; i < most_in_window; ++i) write_one(i);
    }
    to += count;
    return all >> 32 == 0;
  }
};
#endif

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
  // One 1 of the delimiter behind the last number stays as the list's end.
  const auto last = std::to_integer<unsigned>(out.back());
  out.back() = static_cast<std::byte>(last ^ std::bit_floor(last));
  if (last == 1) out.pop_back();
}

bool DelimitedReader::has_fast_extraction() {
#if defined(__x86_64__)
  // Before Zen 3 AMD's processors execute it bit by bit.
  static const bool has =
      __builtin_cpu_supports("bmi2") && !__builtin_cpu_is("amdfam15h") && !__builtin_cpu_is("amdfam17h");
  return has;
#else
  return false;
#endif
}

DelimitedReader::DelimitedReader(std::span<const std::byte> bytes, bool by_extraction)
    : bytes_(bytes.data()), tail_begin_(0), next_(0), stop_(0), by_extraction_(by_extraction) {
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

// The ones from `place` on; at `enough` it may stop counting.
std::int64_t DelimitedReader::ones_from(std::int64_t place, std::int64_t enough) const {
  for (std::int64_t count = 0; count < enough; count += window_bits) {
    if (const u64 zeros = zeros_from(place + count); zeros != 0) return count + std::countr_zero(zeros);
  }
  return enough;
}

// Reads the number behind the delimiter at next_, whatever follows it, and the numbers 1 that follow and fit.
std::uint32_t* DelimitedReader::read_run(std::uint32_t* to, std::uint32_t* end) {
  constexpr const char* too_large = "a number above 2^32 - 1";
  const auto write_ones = [&](std::int64_t ones_there) {
    const std::int64_t count = std::min<std::int64_t>((ones_there - 3) / 4, end - to);
    to = std::fill_n(to, count, 1u);
    next_ += 4 * count;
  };
  const std::int64_t begin = next_ + 2;
  const u64 zeros = zeros_from(next_), ones = ~zeros;
  const int head = std::countr_zero(zeros) - 2;
  if (head == 0) fail(begin, "a number that begins with 0");
  if (head >= 5) {
    write_ones(ones_from(next_, 4 * (end - to) + 3));
    return to;
  }
  if (head >= 3 || begin > stop_) fail(begin, "ones of no count that numbers make");
  const u64 third = ones & ones << 1 & ones << 2 & ~low_bits(4);  // of the ones behind this number
  if (third == 0) fail(begin, too_large);
  const std::int64_t run = next_ + std::countr_zero(third) - 2;
  const std::int64_t ones_there = ones_from(run, stop_ + 3 - run);
  next_ = run + ((ones_there - 3) & 2);
  const auto length = static_cast<unsigned>(next_ - begin);
  if (length > longest_delimited(32)) fail(begin, too_large);
  const u64 number = number_of_code({ones >> 2 & low_bits(length), length});
  if (number >> 32 != 0) fail(begin, too_large);
  *to++ = static_cast<std::uint32_t>(number);
  write_ones(ones_there);
  return to;
}

template <typename Numbers>
std::size_t DelimitedReader::read_by(std::span<std::uint32_t> out) {
  std::uint32_t* to = out.data();
  std::uint32_t* const end = to + out.size();
  std::uint32_t* const limit = end - 2 * (most_in_window + 1);
  // A window's numbers are written while the next window's are found: within each task the steps wait for one another, so the
  // processor interleaves the two.
  Numbers found;
  const auto write = [&] {
    if (found.ends != 0 && !found.write(to)) [[unlikely]] {
      next_ = found.place;
      for (;;) read_run(out.data(), end);  // throws, with the number's place
    }
  };
  while (to <= limit && next_ < stop_) {
    const Starts starts = starts_in(zeros_from(next_));
    write();
    if ((starts.all & 4) != 0 && starts.all != 4) [[likely]] {
      found = Numbers::of(starts, next_);
      next_ += 61 - std::countl_zero(starts.heads);
    } else {
      found = {};
      to = read_run(to, end);
    }
  }
  write();
  return static_cast<std::size_t>(to - out.data());
}

std::size_t DelimitedReader::read(std::span<std::uint32_t> out) {
  assert(out.size() >= least_room);
#if defined(__x86_64__)
  if (by_extraction_) return read_by<NumbersByExtraction>(out);
#endif
  return read_by<NumbersByTable>(out);
}

}  // namespace vismat
