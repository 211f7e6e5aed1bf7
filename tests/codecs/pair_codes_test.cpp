// Codes for a row's gaps and runs: every list comes back, damage is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "codecs/entropy/ans.h"
#include "codecs/entropy/huffman.h"
#include "codecs/integer_codes/interpolative.h"
#include "codecs/integer_codes/lzw.h"
#include "codecs/integer_codes/pair_huffman.h"
#include "codecs/integer_codes/rice.h"
#include "codecs/integer_codes/universal_codes.h"
#include "codecs/rows/elias_fano_rows.h"
#include "codecs/rows/pairs.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "tests/codecs/coded_lists.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

using Numbers = std::vector<std::uint32_t>;
using Bytes = std::vector<std::byte>;
using test::code_lists;
using test::has_model;

template <typename Code>
Numbers read_list(const Code& code, std::span<const std::byte> bytes, std::size_t room = 256) {
  typename Code::Reader reader(code, bytes);
  Numbers all, piece(room);
  while (const std::size_t count = reader.read(piece)) {
    all.insert(all.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
    // What damaged bytes claim may be long: only an interpolative list, of ones, takes no bits for a number.
    if (all.size() > 100000) break;
  }
  return all;
}

std::vector<Numbers> assorted_lists() {
  std::vector<Numbers> lists = {{}, {1}, {2}, {1, 1}, {0xffffffff}, {0xffffffff, 0xffffffff, 1, 0xffffffff}};
  for (unsigned bit = 1; bit < 32; ++bit) {
    const std::uint32_t power = std::uint32_t{1} << bit;
    lists.push_back({power});
    lists.push_back({power - 1, power, power + 1});
    lists.push_back({1, power - 1, 1, power, power + 1, 1, 1});
  }
  lists.emplace_back(1000, 1);
  lists.emplace_back(70000, 2);
  Random random(11);
  for (const std::uint32_t count : {3u, 10u, 255u, 256u, 257u, 5000u, 40000u}) {
    for (const unsigned most_bits : {1u, 4u, 9u, 32u}) {
      Numbers list;
      for (std::uint32_t i = 0; i < count; ++i) {
        const unsigned bits = 1 + random.below(most_bits);
        list.push_back(std::max<std::uint32_t>(1, static_cast<std::uint32_t>(random.next() >> (64 - bits))));
      }
      lists.push_back(list);
    }
  }
  Numbers repeated;  // long phrases for LZW, each the one before and a number more
  for (std::uint32_t i = 0; i < 300; ++i) {
    for (std::uint32_t j = 0; j < i; ++j) repeated.push_back(1 + j % 7);
  }
  lists.push_back(repeated);
  return lists;
}

template <typename Code>
class EveryPairCode : public testing::Test {};
using PairCodes = testing::Types<GammaCode, DeltaCode, RiceCode, InterpolativeCode, OwnHuffmanCode,
                                 SharedHuffmanCode, LzwCode, AnsCode>;
TYPED_TEST_SUITE(EveryPairCode, PairCodes);

TYPED_TEST(EveryPairCode, GivesListsBack) {
  const auto lists = assorted_lists();
  const auto coded = code_lists<TypeParam>(lists);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    EXPECT_EQ(coded.lists[i].empty(), lists[i].empty()) << "list " << i;
    for (const std::size_t room : {1u, 3u, 256u})
      ASSERT_EQ(read_list(coded.reader, coded.lists[i], room), lists[i]) << "list " << i << ", room " << room;
  }
}

// A model of one list each, so that tables of one symbol, or of none for runs, are met too.
TYPED_TEST(EveryPairCode, GivesEachListBackAlone) {
  for (const Numbers& list : assorted_lists()) {
    if (list.size() > 5000) continue;
    const auto coded = code_lists<TypeParam>({list});
    ASSERT_EQ(read_list(coded.reader, coded.lists[0]), list);
  }
}

TYPED_TEST(EveryPairCode, RefusesEveryPrefixAndOneMoreByte) {
  Random random(12);
  Numbers list;
  for (int i = 0; i < 200; ++i) list.push_back(1 + random.below(random.below(20) == 0 ? 100000 : 12));
  const auto coded = code_lists<TypeParam>({list});
  Bytes bytes = coded.lists[0];
  for (std::size_t n = 1; n < bytes.size(); ++n) {
    try {
      EXPECT_NE(read_list(coded.reader, std::span(bytes).first(n)), list) << n << " bytes";
    } catch (const FormatError&) {
    }
  }
  bytes.push_back(std::byte{0});
  EXPECT_THROW(read_list(coded.reader, bytes), FormatError);
}

// Codes with one way to write a list: what is accepted is what put() makes of it.
template <typename Code>
constexpr bool canonical = !std::is_same_v<Code, RiceCode> && !std::is_same_v<Code, OwnHuffmanCode> &&
                           !std::is_same_v<Code, LzwCode>;

TYPED_TEST(EveryPairCode, ReadsDamagedBytesAsOtherNumbersOrNotAtAll) {
  Random random(13);
  Numbers list;
  for (int i = 0; i < 60; ++i) list.push_back(1 + random.below(random.below(15) == 0 ? 3000000 : 9));
  TypeParam writer;
  if constexpr (has_model<TypeParam>) {
    Bytes model;
    writer.see(list);
    writer.write_model(model);
    ByteReader in(model, "model");
    writer.read_model(in);
  }
  Bytes good;
  writer.put(good, list);
  std::size_t accepted = 0;
  const auto try_bytes = [&](const Bytes& bytes) {
    Numbers numbers;
    try {
      numbers = read_list(writer, bytes);
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()), "");
      return;
    }
    if (numbers.size() > 100000) return;
    ++accepted;
    EXPECT_EQ(std::count(numbers.begin(), numbers.end(), 0u), 0);
    if constexpr (canonical<TypeParam>) {
      Bytes again;
      writer.put(again, numbers);
      EXPECT_EQ(again, bytes);
    }
  };
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    try_bytes(bad);
  }
  EXPECT_GT(accepted, 0u);
  for (int trial = 0; trial < test::trials(20000); ++trial) {
    Bytes noise(1 + random.below(24));
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random.below(256) & random.below(256));
    try_bytes(noise);
  }
}

TYPED_TEST(EveryPairCode, ReadsNoTwoShortStringsAlike) {
  if constexpr (canonical<TypeParam> && !has_model<TypeParam>) {
    const TypeParam reader;
    TypeParam writer;
    for (std::uint32_t value = 0; value < 1u << 16; ++value) {
      Bytes bytes = {static_cast<std::byte>(value & 255), static_cast<std::byte>(value >> 8)};
      Numbers numbers;
      try {
        numbers = read_list(reader, bytes);
      } catch (const FormatError&) {
        continue;
      }
      if (numbers.size() > 100000) continue;
      Bytes again;
      writer.put(again, numbers);
      ASSERT_EQ(again, bytes) << value;
    }
  }
}

// The test vectors of docs/vmat.md: the bytes of one list, and of the model that it makes.
TEST(GoldenLists, OfEveryCode) {
  const Numbers list = {5, 2, 1, 1, 3, 1, 70, 4, 1, 2};
  const auto hex = [](const Bytes& bytes) {
    std::string text;
    for (const std::byte byte : bytes) {
      constexpr std::string_view digits = "0123456789abcdef";
      text += digits[std::to_integer<unsigned>(byte) >> 4];
      text += digits[std::to_integer<unsigned>(byte) & 15];
    }
    return text;
  };
  const auto model_and_list = [&]<typename Code>(Code code) {
    Bytes model, bytes;
    if constexpr (has_model<Code>) {
      code.see(list);
      code.write_model(model);
    }
    code.put(bytes, list);
    return std::pair(hex(model), hex(bytes));
  };
  using Texts = std::pair<std::string, std::string>;
  EXPECT_EQ(model_and_list(GammaCode{}), Texts("", "4c3bd02015"));
  EXPECT_EQ(model_and_list(DeltaCode{}), Texts("", "4ed6dc3025"));
  EXPECT_EQ(model_and_list(RiceCode{}), Texts("", "0369ac008b61"));
  EXPECT_EQ(model_and_list(InterpolativeCode{}), Texts("", "0a5087471f98"));
  EXPECT_EQ(model_and_list(OwnHuffmanCode{}), Texts("", "411223f0f0f0a00313c2ad18"));
  EXPECT_EQ(model_and_list(SharedHuffmanCode{}),
            Texts("0200020002f0f0f0a002f0f0f0f0f0f06002010002f0f0f0f0f0f0f0f0f0f030", "21db46"));
  EXPECT_EQ(model_and_list(LzwCode{}), Texts("", "050202041810c00881000202"));
  // 65 shares of gaps' symbols, of which those of 1, 3, 5 and 70 are not 0; 4 of runs'
  EXPECT_EQ(model_and_list(AnsCode{}),
            Texts("41b506009903009903" + std::string(2 * 59, '0') + "990304b406b306009903", "47e1b56601"));
  Bytes row;
  EliasFanoRows{100}.encode(std::vector<std::uint32_t>{4, 5, 7, 11, 82, 83, 84, 85, 87, 88}, row);
  EXPECT_EQ(hex(row), "0aeca7b10717c017");
}

// --- Parts ---------------------------------------------------------------------------------------------------------------

TEST(HuffmanTable, IsAsShortAsHuffmanCode) {
  Random random(14);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<std::uint64_t> counts(1 + random.below(LengthSymbol::count));
    for (auto& count : counts) count = random.below(3) == 0 ? 0 : 1 + random.below(1u << random.below(12));
    if (trial == 0) {  // the deepest tree: lengths are cut
      counts = {1, 1};
      while (counts.size() < 40) counts.push_back(counts[counts.size() - 1] + counts[counts.size() - 2]);
    }
    Bytes ours, theirs;
    HuffmanTable::write(ours, counts);
    HuffmanCode::from_frequencies(counts).write(theirs);
    const auto cost = [&](const Bytes& bytes) {
      std::uint64_t bits = 0;
      std::size_t s = 0;
      for (const std::byte byte : bytes) {
        for (unsigned i = 0; i <= std::to_integer<unsigned>(byte) >> 4; ++i)
          bits += counts[s++] * (std::to_integer<unsigned>(byte) & 15);
      }
      EXPECT_EQ(s, counts.size());
      return bits;
    };
    EXPECT_LE(cost(ours), cost(theirs));
    ByteReader in(ours, "table");
    EXPECT_NO_THROW(HuffmanTable::read(in, static_cast<std::uint32_t>(counts.size())));
    EXPECT_EQ(in.left(), 0u);
  }
}

TEST(HuffmanTable, RefusesBadLengths) {
  const auto read = [](std::vector<unsigned char> bytes) {
    ByteReader in(std::as_bytes(std::span(bytes)), "table");
    HuffmanTable::read(in, 4);
  };
  EXPECT_THROW(read({0x11, 0x11}), FormatError);  // four codes of one bit
  EXPECT_THROW(read({0x42}), FormatError);        // a fifth symbol
  EXPECT_THROW(read({0x12, 0x10}), FormatError);  // half of the codes mean nothing
  EXPECT_THROW(read({0x22}), FormatError);        // cut short
  EXPECT_NO_THROW(read({0x32}));
  EXPECT_NO_THROW(read({0x30}));  // no symbol occurs
}

TEST(AnsTable, RefusesSharesThatAreNone) {
  const auto read = [](const std::vector<std::uint64_t>& varints) {
    Bytes bytes;
    for (const std::uint64_t value : varints) put_varint(bytes, value);
    ByteReader in(bytes, "table");
    AnsTable::read(in);
  };
  EXPECT_NO_THROW(read({2, 2047, 1}));
  EXPECT_NO_THROW(read({0}));
  EXPECT_THROW(read({1, 2048}), FormatError);     // all states: numbers would take no bits at all
  EXPECT_THROW(read({2, 2047, 2}), FormatError);  // more than all
  EXPECT_THROW(read({2, 2046, 1}), FormatError);
  EXPECT_THROW(read({3, 2047, 1, 0}), FormatError);  // shorter without the last
  EXPECT_THROW(read({169}), FormatError);
  EXPECT_THROW(read({2, 2047}), FormatError);
  EXPECT_THROW(read({2, ~std::uint64_t{0}, 1}), FormatError);
}

// What no encoder makes, by hand. The parts of a list are (bits, how many).
Bytes list_of(Bytes before, std::initializer_list<std::pair<std::uint64_t, unsigned>> parts) {
  ListWriter bits(before);
  for (const auto& [part, count] : parts) bits.put(part, count);
  bits.finish();
  return before;
}

TEST(Gamma, RefusesNumbersThatAreCutOrTooLarge) {
  EXPECT_EQ(read_list(GammaCode{}, list_of({}, {{0, 29}, {1, 1}, {3, 29}})), Numbers{(1u << 29) + 3});
  EXPECT_THROW(read_list(GammaCode{}, list_of({}, {{0, 29}})),
               FormatError);  // the list's end is taken for the 1
  EXPECT_THROW(read_list(GammaCode{}, list_of({}, {{0, 29}, {1, 1}, {3, 28}})), FormatError);
  EXPECT_THROW(read_list(GammaCode{}, list_of({}, {{0, 32}, {1, 1}, {0, 32}})), FormatError);
}

TEST(Rice, RefusesLongFormsOfSmallNumbers) {
  const auto long_form = [](std::uint32_t number) {
    return list_of({std::byte{0x02}}, {{0, 24}, {number, 32}});  // k = 2 for gaps
  };
  EXPECT_EQ(read_list(RiceCode{}, long_form(4 * 24 + 1)), Numbers{4 * 24 + 1});
  EXPECT_THROW(read_list(RiceCode{}, long_form(4 * 24)), FormatError);
  EXPECT_THROW(read_list(RiceCode{}, long_form(0)), FormatError);
}

TEST(Interpolative, RefusesSumsThatNumbersCannotHave) {
  const auto list_of_one = [](std::uint64_t number) {
    Bytes bytes = {std::byte{1}};
    put_varint(bytes, number - 1);
    return list_of(bytes, {});
  };
  EXPECT_EQ(read_list(InterpolativeCode{}, list_of_one(0xffffffff)), Numbers{0xffffffff});
  EXPECT_THROW(read_list(InterpolativeCode{}, list_of_one(0x100000000)), FormatError);
  EXPECT_THROW(read_list(InterpolativeCode{}, list_of_one((std::uint64_t{1} << 56) + 1)), FormatError);
}

TEST(Lzw, RefusesNumbersThatAreNone) {
  const auto list_of_bytes = [](std::initializer_list<unsigned> text) {
    Bytes bytes;
    ListWriter bits(bytes);
    unsigned width = 8;
    for (const unsigned byte : text) bits.put(byte, std::exchange(width, 9));
    bits.finish();
    return bytes;
  };
  EXPECT_EQ(read_list(LzwCode{}, list_of_bytes({0xff, 0xff, 0xff, 0xff, 0x0f})), Numbers{0xffffffff});
  EXPECT_THROW(read_list(LzwCode{}, list_of_bytes({0x80, 0x80, 0x80, 0x80, 0x10})), FormatError);  // 2^32
  EXPECT_THROW(read_list(LzwCode{}, list_of_bytes({0x81, 0x00})), FormatError);  // 1 in two bytes
  EXPECT_THROW(read_list(LzwCode{}, list_of_bytes({0x00})), FormatError);
  EXPECT_THROW(read_list(LzwCode{}, list_of_bytes({0x81})), FormatError);
  EXPECT_THROW(read_list(LzwCode{}, list_of({}, {{1, 8}, {257, 9}})),
               FormatError);  // the entry after the open one
}

TEST(OwnHuffman, RefusesBitsThatAreNoCode) {
  const Bytes only_one = {std::byte{1}, std::byte{0x01}};  // one symbol, of one bit: 0
  EXPECT_EQ(read_list(OwnHuffmanCode{}, list_of(only_one, {{0, 3}})), (Numbers{1, 1, 1}));
  EXPECT_THROW(read_list(OwnHuffmanCode{}, list_of(only_one, {{1, 1}, {0, 1}})), FormatError);
  EXPECT_THROW(read_list(OwnHuffmanCode{}, list_of(only_one, {})), FormatError);
  EXPECT_THROW(read_list(OwnHuffmanCode{}, only_one), FormatError);
  EXPECT_THROW(read_list(OwnHuffmanCode{}, Bytes{std::byte{0}}), FormatError);
  EXPECT_THROW(read_list(OwnHuffmanCode{}, Bytes{std::byte{169}}), FormatError);
}

TEST(Rice, ChoosesParametersForEachRow) {
  Numbers list;
  for (int i = 0; i < 100; ++i) list.insert(list.end(), {1000u + static_cast<std::uint32_t>(i), 1u});
  const auto coded = code_lists<RiceCode>({list});
  EXPECT_EQ(coded.lists[0].size(), 1 + (25 * 11 + 75 * 12 + 100 + 1 + 7) / 8u);  // k = 10 and 0
}

}  // namespace
}  // namespace vismat
