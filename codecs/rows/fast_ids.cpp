// ALGORITHM. Runs of ids in whole bytes, for decoders that write ids.
//
// A run is a token of one byte, which names its gap and its length, and raw bytes if they are rare. Tokens and raw bytes
// lie apart, tokens from the row's end backwards, so that neither must wait for the other: what is carried from run to
// run is the place among the raw bytes, and the column, by one addition each. A class is a base and a mask, so no branch
// asks what kind it is. Both ways meet where the row ends, which is why no number of runs is stored. The 32 classes are
// 512 bytes, which a cold decoder loads from memory.
//
// IdSink::runs writes 32 ids at once whatever the length, so only longer runs (a fifth on levels) are guessed wrong.
//
// The limit (koth1's view cells in the order `best`, 22 runs and 409 ids a row; 2.9 GHz). 38 bytes are read and 1.6 kB
// written: 50 stores of 32 bytes, or 22 runs of 4, take 45 cycles at 2 a cycle. A run is some 35 instructions, 9 cycles;
// so 200 cycles a row, 70 ns. It takes 155 ns: 0.3 wrong guesses a run, at 20 cycles, are most of what is lost. Out of a
// file a row takes 195 ns, of which 32 ns are its place in the index.
//
// Tried and found larger or slower: pairs of bytes (gap, length), longer ones as several pairs, +30 %; a row equal to the
// one before stored once, in groups of 8 rows, -1 % on view cells and faces and +2 % on differences; writing 8 or 16 ids
// at once, 1.2 to 1.6 times the time, and 64, the same; raw bytes behind each token, which are found one after the other.
#include "codecs/rows/fast_ids.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace vismat {
namespace {

// A number and how often it occurs.
struct Counted {
  std::uint32_t number;
  std::uint64_t times;
};

std::vector<Counted> counted(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  std::vector<Counted> all;
  for (const std::uint32_t number : numbers) {
    if (all.empty() || all.back().number != number) all.push_back({number, 0});
    ++all.back().times;
  }
  return all;
}

}  // namespace

FastIdRows::Class FastIdRows::class_of(unsigned bytes, std::uint64_t base) {
  return {base, static_cast<std::uint32_t>((std::uint64_t{1} << (8 * bytes)) - 1),
          static_cast<std::uint8_t>(bytes)};
}

// The numbers from 1 on are cut into ranges: up to six of 256 numbers, then one of 65536, then one of all, as far as
// there are numbers. The other classes are single numbers, those that save the most raw bytes and more than a class takes
// in the model. Every number of ranges of 256 is tried.
FastIdRows::Classes FastIdRows::classes_for(std::vector<std::uint32_t>& numbers) {
  const std::vector<Counted> all = counted(numbers);
  Classes best;
  if (all.empty()) return best;
  const std::uint32_t largest = all.back().number;
  std::uint64_t best_bytes = ~std::uint64_t{0};
  for (unsigned ranges = 0; ranges <= 6; ++ranges) {
    std::vector<Class> classes;
    for (unsigned r = 0; r < ranges; ++r) classes.push_back(class_of(1, 1 + 256 * r));
    const std::uint32_t wide = 1 + 256 * ranges;
    if (largest >= wide) classes.push_back(class_of(2, wide));
    if (largest >= wide + 0x10000) classes.push_back(class_of(4, wide + 0x10000));
    const auto raw_bytes = [&](std::uint32_t number) {
      return std::ranges::find_if(classes, [&](const Class& c) { return c.holds(number); })->bytes;
    };
    const auto model_bytes = [](std::uint32_t base) { return 1 + varint_bytes(base); };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> savings;
    std::uint64_t bytes = 0;
    for (const Class& c : classes) bytes += model_bytes(static_cast<std::uint32_t>(c.base));
    for (const auto [number, times] : all) {
      const std::uint64_t raw = times * raw_bytes(number);
      bytes += raw;
      if (raw > model_bytes(number))
        savings.emplace_back(raw - model_bytes(number), ~number);  // of equal ones the smaller number's first
    }
    std::ranges::sort(savings, std::greater());
    savings.resize(std::min(savings.size(), best.size() - classes.size()));
    for (const auto& [saved, number] : savings) {
      classes.push_back(class_of(0, ~number));
      bytes -= saved;
    }
    if (bytes >= best_bytes) continue;
    best_bytes = bytes;
    std::ranges::sort(classes, {}, [](const Class& c) { return std::pair(c.bytes, c.base); });
    best = {};
    std::ranges::copy(classes, best.begin());
  }
  return best;
}

FastIdRows FastIdRows::fit(const VisibilityMatrix& matrix) {
  FastIdRows rows;
  std::vector<std::uint32_t> gaps, lengths;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto pairs = pairs_of_row(matrix.row(r), rows.memory_);
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      gaps.push_back(pairs[i]);
      lengths.push_back(pairs[i + 1]);
    }
  }
  rows.gaps_ = classes_for(gaps);
  rows.lengths_ = classes_for(lengths);
  return rows;
}

void FastIdRows::write_model(std::vector<std::byte>& out) const {
  for (const Classes& classes : {gaps_, lengths_}) {
    const auto exists = [](const Class& c) { return c.base <= 0xffffffff; };
    const auto count = std::ranges::count_if(classes, exists);
    out.push_back(static_cast<std::byte>(count));
    for (const Class& c : std::span(classes).first(static_cast<std::size_t>(count))) {
      out.push_back(std::byte{c.bytes});
      put_varint(out, c.base);
    }
  }
}

FastIdRows FastIdRows::read_model(ByteReader& in, Shape) {
  FastIdRows rows;
  for (Classes* const classes : {&rows.gaps_, &rows.lengths_}) {
    const unsigned count = in.number<std::uint8_t>();
    if (count > classes->size()) in.fail(std::to_string(count) + " classes; there are at most 16");
    for (Class& c : std::span(*classes).first(count)) {
      const unsigned bytes = in.number<std::uint8_t>();
      const std::uint64_t base = in.varint();
      if (bytes > 4 || bytes == 3) in.fail("a class of " + std::to_string(bytes) + " raw bytes");
      if (base == 0 || base > 0xffffffff) in.fail("a class that begins at " + std::to_string(base));
      c = class_of(bytes, base);
    }
  }
  return rows;
}

void FastIdRows::encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) {
  const auto pairs = pairs_of_row(ids, memory_);
  std::vector<std::byte> codes;
  const auto put = [&](const Classes& classes, std::uint32_t number) {
    const auto found = std::ranges::find_if(classes, [=](const Class& c) { return c.holds(number); });
    for (unsigned i = 0; i < found->bytes; ++i)
      out.push_back(static_cast<std::byte>((number - found->base) >> (8 * i) & 0xff));
    return static_cast<unsigned>(found - classes.begin());
  };
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    const unsigned gap = put(gaps_, pairs[i]);
    codes.push_back(static_cast<std::byte>(gap | put(lengths_, pairs[i + 1]) << 4));
  }
  out.insert(out.end(), codes.rbegin(), codes.rend());
}

}  // namespace vismat
