// The parts below the codecs: bit streams, length symbols, Huffman codes, the range coder.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/huffman.h"
#include "codecs/entropy/range_coder.h"
#include "codecs/entropy/run_length_symbols.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

std::vector<std::uint64_t> fibonacci(std::size_t count) {  // makes the deepest Huffman tree
  std::vector<std::uint64_t> f = {1, 1};
  while (f.size() < count) f.push_back(f[f.size() - 1] + f[f.size() - 2]);
  f.resize(count);
  return f;
}

std::vector<std::vector<std::uint64_t>> frequency_cases() {
  return {{5},
          {0, 0, 7},
          {1, 1},
          {3, 0, 1, 9, 0},
          fibonacci(40),
          std::vector<std::uint64_t>(168, 1),
          {1000000, 1, 1, 0, 1}};
}

std::vector<std::uint32_t> draw(const std::vector<std::uint64_t>& frequencies, std::size_t count) {
  Random random(1);
  std::vector<std::uint32_t> symbols;
  for (std::uint32_t s = 0; s < frequencies.size(); ++s) {
    if (frequencies[s] > 0) symbols.push_back(s);
  }
  std::vector<std::uint32_t> drawn(symbols);
  while (drawn.size() < count)
    drawn.push_back(symbols[random.below(static_cast<std::uint32_t>(symbols.size()))]);
  return drawn;
}

TEST(BitStream, GivesBackWhatWasPut) {
  Random random(3);
  std::vector<std::pair<std::uint32_t, unsigned>> items;
  std::vector<std::byte> bytes;
  BitWriter out(bytes);
  for (int i = 0; i < 1000; ++i) {
    const unsigned count = random.below(33);
    const auto bits = static_cast<std::uint32_t>(random.next() & ((std::uint64_t{1} << count) - 1));
    items.emplace_back(bits, count);
    out.put(bits, count);
  }
  out.flush();
  BitReader in(bytes);
  for (const auto& [bits, count] : items) EXPECT_EQ(in.get(count), bits);
  EXPECT_NO_THROW(in.finish());
  EXPECT_FALSE(in.overran());
  in.get(32);
  EXPECT_TRUE(in.overran());
}

TEST(BitStream, RefusesPaddingAndBytesLeftOver) {
  const std::vector<std::byte> bytes = {std::byte{0x81}};
  BitReader in(bytes);
  in.get(1);
  EXPECT_THROW(in.finish(), FormatError);  // a padding bit is set
  BitReader untouched(bytes);
  EXPECT_THROW(untouched.finish(), FormatError);
}

TEST(LengthSymbols, AreABijection) {
  std::uint32_t next_symbol = 0;
  for (std::uint64_t length = 1; length <= 0xffffffff; length = length < 5000 ? length + 1 : length * 9 / 8) {
    const LengthSymbol s = symbol_of_length(static_cast<std::uint32_t>(length));
    EXPECT_EQ(length_of_symbol(s.symbol, s.raw), length);
    EXPECT_EQ(raw_bits_of_symbol(s.symbol), s.raw_count);
    EXPECT_LT(s.symbol, LengthSymbol::count);
    EXPECT_LT(s.raw, std::uint64_t{1} << s.raw_count);
    EXPECT_GE(s.symbol, next_symbol == 0 ? 0 : next_symbol - 1);
    next_symbol = s.symbol + 1;
  }
  EXPECT_EQ(symbol_of_length(0xffffffff).symbol, LengthSymbol::count - 1);
}

TEST(Huffman, RoundTripsAndItsTableToo) {
  for (const auto& frequencies : frequency_cases()) {
    const auto code = HuffmanCode::from_frequencies(frequencies);
    const auto symbols = draw(frequencies, 500);
    std::vector<std::byte> table, bytes;
    code.write(table);
    BitWriter out(bytes);
    for (const std::uint32_t s : symbols) code.put(out, s);
    out.flush();
    ByteReader reader(table, "table");
    const auto read = HuffmanCode::read(reader, static_cast<std::uint32_t>(frequencies.size()));
    EXPECT_EQ(reader.left(), 0u);
    BitReader in(bytes);
    for (const std::uint32_t s : symbols) ASSERT_EQ(read.get(in), s);
    EXPECT_NO_THROW(in.finish());
  }
}

TEST(Huffman,
     IsOptimalWhereNoLengthIsCut) {  // against the cost of merging the two least weights, by definition
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<std::uint64_t> frequencies(2 + random.below(30));
    for (auto& f : frequencies) f = 1 + random.below(200);
    std::vector<std::uint64_t> heap(frequencies);
    std::uint64_t best = 0;
    while (heap.size() > 1) {
      std::sort(heap.rbegin(), heap.rend());
      const std::uint64_t sum = heap.back() + heap[heap.size() - 2];
      heap.resize(heap.size() - 2);
      heap.push_back(sum);
      best += sum;
    }
    const auto code = HuffmanCode::from_frequencies(frequencies);
    std::uint64_t cost = 0;
    for (std::uint32_t s = 0; s < frequencies.size(); ++s) {
      std::vector<std::byte> bytes;
      BitWriter out(bytes);
      for (int i = 0; i < 8; ++i) code.put(out, s);  // 8 codes fill as many bytes as one has bits
      out.flush();
      cost += bytes.size() * frequencies[s];
    }
    EXPECT_EQ(cost, best);
  }
}

TEST(Huffman, RefusesBadTables) {
  const auto read = [](std::vector<unsigned char> bytes) {
    ByteReader in(std::as_bytes(std::span(bytes)), "table");
    return HuffmanCode::read(in, 4);
  };
  EXPECT_THROW(read({0x11, 0x11}), FormatError);   // four codes of one bit
  EXPECT_THROW(read({0x42}), FormatError);         // a fifth symbol
  EXPECT_THROW(read({0x12, 0x10}), FormatError);   // half of the codes mean nothing
  EXPECT_THROW(read({0x32 - 0x10}), FormatError);  // cut short
  EXPECT_NO_THROW(read({0x32}));
  EXPECT_NO_THROW(read({0x30}));  // no symbol occurs
}

TEST(RangeCoder, RoundTripsAndItsTableToo) {
  for (const auto& frequencies : frequency_cases()) {
    const auto table = FrequencyTable::from_frequencies(frequencies);
    const auto symbols = draw(frequencies, 3000);
    std::vector<std::byte> model, bytes;
    table.write(model);
    ByteReader reader(model, "table");
    const auto read = FrequencyTable::read(reader, static_cast<std::uint32_t>(frequencies.size()));
    RangeEncoder out(bytes);
    for (const std::uint32_t s : symbols) {
      out.put(table, s);
      out.put_raw(s * 5 & 0x1ffff, 17);
    }
    out.finish();
    RangeDecoder in(bytes);
    for (const std::uint32_t s : symbols) {
      ASSERT_EQ(in.get(read), s);
      ASSERT_EQ(in.get_raw(17), (s * 5 & 0x1ffff));
    }
  }
}

TEST(RangeCoder, ShortStreamsTakeFewBytesAndSurviveCarries) {
  const auto table = FrequencyTable::from_frequencies(std::vector<std::uint64_t>{60000, 1, 1, 60000});
  Random random(7);
  for (int trial = 0; trial < 5000; ++trial) {
    std::vector<std::uint32_t> symbols(random.below(40));
    for (auto& s : symbols) s = random.below(8) == 0 ? random.below(4) : 3;
    std::vector<std::byte> bytes;
    RangeEncoder out(bytes);
    double bits = 0;
    for (const std::uint32_t s : symbols) {
      out.put(table, s);
      bits -= std::log2(table.frequency(s) / 16384.0);
    }
    out.finish();
    EXPECT_LE(static_cast<double>(bytes.size()), bits / 8 + 2);
    RangeDecoder in(bytes);
    for (const std::uint32_t s : symbols) ASSERT_EQ(in.get(table), s);
  }
}

TEST(RangeCoder, RefusesBadTables) {
  const auto read = [](std::vector<unsigned char> bytes) {
    ByteReader in(std::as_bytes(std::span(bytes)), "table");
    return FrequencyTable::read(in, 4);
  };
  EXPECT_THROW(read({2, 0x80, 0x40, 1}), FormatError);     // 2^13 + 1
  EXPECT_THROW(read({2, 0x80, 0x80, 1, 1}), FormatError);  // 2^14 + 1
  EXPECT_THROW(read({5, 0, 0, 0, 0, 0}), FormatError);     // five symbols
  EXPECT_THROW(read({2, 1}), FormatError);                 // cut short
  EXPECT_NO_THROW(read({1, 0x80, 0x80, 1}));
  EXPECT_NO_THROW(read({0}));
}

}  // namespace
}  // namespace vismat
