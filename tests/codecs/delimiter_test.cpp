// The delimiter code: its rules, the proof that it can be read, and the fast decoder beside the paper's pass bit by bit.
#include "codecs/integer_codes/delimiter.h"
#include "codecs/integer_codes/delimiter_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

#include "matrix/base/random.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

using Numbers = std::vector<std::uint32_t>;
using reference::bytes_of_bits;
using reference::delimited_by_rules;

std::vector<std::byte> encoded(const Numbers& numbers) {
  std::vector<std::byte> bytes;
  put_delimited(bytes, numbers);
  return bytes;
}

// The decoder's ways on this machine.
std::span<const bool> ways() {
  static constexpr bool all[] = {false, true};
  return std::span(all).first(DelimitedReader::has_fast_extraction() ? 2 : 1);
}

Numbers decoded(std::span<const std::byte> bytes, bool by_extraction,
                std::size_t room = DelimitedReader::least_room) {
  // Memory of their own, so that a sanitizer sees a read past the end.
  const std::vector<std::byte> exact(bytes.begin(), bytes.end());
  DelimitedReader reader(exact, by_extraction);
  Numbers numbers, piece(room);
  while (const std::size_t count = reader.read(piece)) {
    EXPECT_LE(count, room);
    numbers.insert(numbers.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
  }
  EXPECT_EQ(reader.read(piece), 0u);
  return numbers;
}

// Null where the bytes are refused.
std::optional<Numbers> fast(std::span<const std::byte> bytes, bool by_extraction) {
  try {
    return decoded(bytes, by_extraction);
  } catch (const FormatError&) {
    return std::nullopt;
  }
}

std::optional<Numbers> plain(std::span<const std::byte> bytes) {
  std::vector<std::uint64_t> numbers;
  try {
    reference::read_delimited_by_bits(bytes, numbers);
  } catch (const FormatError&) {
    return std::nullopt;
  }
  Numbers narrow;
  for (const std::uint64_t number : numbers) narrow.push_back(static_cast<std::uint32_t>(number));
  return narrow;
}

// What both decoders must do with any bytes; tells whether they accept them.
void expect_agreement(std::span<const std::byte> bytes, bool* accepted = nullptr) {
  const std::optional<Numbers> numbers = plain(bytes);
  for (const bool way : ways()) ASSERT_EQ(fast(bytes, way), numbers) << "by extraction " << way;
  if (numbers) {
    ASSERT_TRUE(std::ranges::equal(encoded(*numbers), bytes));
  }
  if (accepted != nullptr) *accepted = numbers.has_value();
}

void expect_round_trip(const Numbers& numbers) {
  const std::vector<std::byte> bytes = encoded(numbers);
  ASSERT_EQ(bytes, bytes_of_bits(delimited_by_rules(numbers)));
  for (const bool way : ways()) ASSERT_EQ(decoded(bytes, way), numbers) << "by extraction " << way;
  ASSERT_EQ(plain(bytes), numbers);
}

// Calls visit with each sequence of one to `most` numbers, each from 1 to `largest`.
template <typename Visit>
void each_sequence(std::size_t most, std::uint32_t largest, const Visit& visit) {
  for (std::size_t size = 1; size <= most; ++size) {
    Numbers numbers(size, 1);
    for (;;) {
      visit(numbers);
      std::size_t i = 0;
      while (i < size && numbers[i] == largest) numbers[i++] = 1;
      if (i == size) break;
      ++numbers[i];
    }
  }
}

TEST(Delimiter, FollowsTheRules) {
  const std::map<std::uint32_t, std::string> codes = {
      {1, "11"},      {2, "10"},       {3, "110"},     {4, "100"},    {5, "1011"},
      {6, "1100"},    {7, "11011"},    {9, "10011"},   {11, "10110"}, {13, "110011"},
      {15, "110110"}, {23, "1011011"}, {27, "1100110"}};
  for (const auto& [number, code] : codes) {
    EXPECT_EQ(delimited_by_rules(number), code);
    EXPECT_EQ(encoded({number}), bytes_of_bits(code)) << number;
  }
  EXPECT_EQ(delimited_by_rules(Numbers{5, 3}), "101111110");
  EXPECT_EQ(delimited_by_rules(Numbers{2, 1, 2}), "1011111110");
}

TEST(Delimiter, KeepsItsBytes) {
  const auto bytes_of = [](std::initializer_list<int> values) {
    std::vector<std::byte> bytes;
    for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
    return bytes;
  };
  EXPECT_EQ(encoded({}), bytes_of({}));
  EXPECT_EQ(encoded({1}), bytes_of({0x07}));
  EXPECT_EQ(encoded({5, 3}), bytes_of({0xfd, 0x02}));
  EXPECT_EQ(encoded({1, 1, 1, 1}), bytes_of({0xff, 0x7f}));
  EXPECT_EQ(encoded({0xffffffff}), bytes_of({0xdb, 0xb6, 0x6d, 0xdb, 0xb6, 0x6d, 0x01}));
  EXPECT_EQ(encoded({1000000, 2}), bytes_of({0x9b, 0x90, 0xc0, 0x05}));
}

TEST(Delimiter, AppendsToWhatIsThere) {
  std::vector<std::byte> bytes = encoded({7});
  const std::vector<std::byte> first = bytes;
  put_delimited(bytes, {});
  EXPECT_EQ(bytes, first);
  put_delimited(bytes, Numbers{2, 9});
  EXPECT_EQ(plain(std::span(bytes).first(first.size())), Numbers{7});
  EXPECT_EQ(plain(std::span(bytes).subspan(first.size())), (Numbers{2, 9}));
}

TEST(Delimiter, TakesAtMostHalfAsManyBitsAgain) {
  for (unsigned bits = 1; bits <= 32; ++bits) {
    const auto most = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    EXPECT_EQ(delimited_by_rules(most).size(), longest_delimited(bits));
    const std::uint32_t least = most / 2 + 1;
    std::size_t longest = 0;
    if (bits <= 14) {
      for (std::uint32_t number = least; number <= most; ++number)
        longest = std::max(longest, delimited_by_rules(number).size());
      EXPECT_EQ(longest, longest_delimited(bits));
    }
    Random random(bits);
    for (int trial = 0; trial < 2000; ++trial) {
      const std::uint32_t number = least | (static_cast<std::uint32_t>(random.next() | random.next()) & most);
      longest = std::max(longest, delimited_by_rules(number).size());
    }
    EXPECT_LE(longest, longest_delimited(bits));
  }
}

TEST(Delimiter, NoTwoShortSequencesShareACode) {
  for (const auto& [longest, largest] : {std::pair{7u, 3u}, {5u, 7u}, {4u, 15u}, {3u, 63u}}) {
    const std::uint32_t most = longest - (test::sanitized ? 1 : 0);
    each_sequence(most, largest, [](const Numbers& numbers) { expect_round_trip(numbers); });
    if (HasFatalFailure()) return;
    std::set<std::string> codes;
    std::size_t sequences = 0;
    each_sequence(most, largest, [&](const Numbers& numbers) {
      codes.insert(delimited_by_rules(numbers));
      ++sequences;
    });
    EXPECT_EQ(codes.size(), sequences);
  }
}

TEST(Delimiter, AsPrintedIsAmbiguous) {
  EXPECT_EQ(delimited_by_rules(Numbers{5, 3}, true), "101111110");
  EXPECT_EQ(delimited_by_rules(Numbers{2, 1, 2}, true), "101111110");
  std::set<std::string> codes;
  std::size_t sequences = 0;
  each_sequence(5, 7, [&](const Numbers& numbers) {
    codes.insert(delimited_by_rules(numbers, true));
    ++sequences;
  });
  EXPECT_EQ(sequences, 19607u);
  EXPECT_EQ(sequences - codes.size(), 1062u);
}

// ---- The proof for all lengths -------------------------------------------------------------------------------------------
//
// The rules as a finite automaton that writes the code a bit a step and chooses the numbers, of any size, as it goes. Two
// lists make two different paths; so the code of lists is unique if no bits lie on two paths from the start to an end. That
// is so if, of all pairs of states that two paths over the same bits can reach together and from which they can go on to
// ends together, none has two different states, and no two steps from a state to another write the same bit.

struct Automaton {
  struct Step {
    int from, bit, to;
  };
  std::vector<Step> steps;
  std::set<int> ends;
  static constexpr int start = 0;
};

Automaton automaton_of_rules(bool literal) {
  // What was written last: nothing of this number; its first 1; a later 1 that closes no pair; a 1 that closes a pair;
  // a 0, of the number or behind a pair; the 1 of rule 3; the delimiter's first 1.
  enum { nothing, first_one, one, pair, zero, added, delimiter };
  Automaton rules{{{nothing, 1, first_one},
                   {first_one, 0, zero},
                   {first_one, 1, pair},
                   {one, 0, zero},
                   {one, 1, pair},
                   {one, 1, added},
                   {pair, 0, zero},
                   {zero, 0, zero},
                   {zero, 1, one},
                   {zero, 1, delimiter},
                   {added, 1, delimiter},
                   {delimiter, 1, nothing}},
                  {zero, added}};
  if (literal) {
    rules.ends.insert(first_one);
    rules.steps.push_back({first_one, 1, delimiter});
  } else {
    rules.steps.push_back({first_one, 1, added});
  }
  return rules;
}

// How many paths from the start to an end write each of the bit strings of up to `longest` bits.
std::unordered_map<std::string, int> paths_of(const Automaton& automaton, std::size_t longest) {
  std::unordered_map<std::string, int> counts;
  std::vector<std::pair<int, std::string>> open = {{Automaton::start, ""}};
  while (!open.empty()) {
    const auto [state, bits] = open.back();
    open.pop_back();
    if (automaton.ends.contains(state)) ++counts[bits];
    if (bits.size() == longest) continue;
    for (const Automaton::Step& step : automaton.steps) {
      if (step.from == state) open.emplace_back(step.to, bits + (step.bit == 1 ? '1' : '0'));
    }
  }
  return counts;
}

bool is_unambiguous(const Automaton& automaton) {
  std::set<std::pair<int, int>> steps_between;
  for (const Automaton::Step& step : automaton.steps) {
    if (!steps_between.emplace(step.from * 2 + step.bit, step.to).second) return false;
  }
  using Pair = std::pair<int, int>;
  // Every pair that can be reached from `from`, or that can reach it.
  const auto closure = [&](std::set<Pair> from, bool forward) {
    std::vector<Pair> open(from.begin(), from.end());
    while (!open.empty()) {
      const Pair at = open.back();
      open.pop_back();
      for (const Automaton::Step& a : automaton.steps) {
        for (const Automaton::Step& b : automaton.steps) {
          const Pair source = {a.from, b.from}, target = {a.to, b.to};
          if (a.bit != b.bit || (forward ? source : target) != at) continue;
          const Pair next = forward ? target : source;
          if (from.insert(next).second) open.push_back(next);
        }
      }
    }
    return from;
  };
  std::set<Pair> both_end;
  for (const int a : automaton.ends) {
    for (const int b : automaton.ends) both_end.emplace(a, b);
  }
  const std::set<Pair> reached = closure({{Automaton::start, Automaton::start}}, true);
  const std::set<Pair> ending = closure(both_end, false);
  return std::ranges::none_of(reached, [&](Pair at) { return at.first != at.second && ending.contains(at); });
}

TEST(DelimiterProof, TheAutomatonIsThatOfTheRules) {
  constexpr std::size_t longest = 12;
  for (const bool literal : {false, true}) {
    std::unordered_map<std::string, int> codes;
    // Every list whose code has at most `longest` bits.
    const auto extend = [&](const auto& self, const Numbers& numbers) -> void {
      for (std::uint32_t number = 1; number < 1u << longest; ++number) {
        Numbers longer = numbers;
        longer.push_back(number);
        const std::string code = delimited_by_rules(longer, literal);
        if (code.size() <= longest) {
          ++codes[code];
          self(self, longer);
        } else if (code.size() > longest + longest / 2) {
          break;  // a larger number's code is shorter by a third at most
        }
      }
    };
    extend(extend, {});
    EXPECT_EQ(paths_of(automaton_of_rules(literal), longest), codes) << "literal " << literal;
  }
}

TEST(DelimiterProof, NoTwoListsOfAnyLengthShareACode) {
  EXPECT_TRUE(is_unambiguous(automaton_of_rules(false)));
}

TEST(DelimiterProof, FindsTheRulesAsPrintedAmbiguous) {
  EXPECT_FALSE(is_unambiguous(automaton_of_rules(true)));
  EXPECT_GE(paths_of(automaton_of_rules(true), 9).at("101111110"), 2);
}

// ---- The fast decoder ----------------------------------------------------------------------------------------------------

TEST(DelimitedReader, ReadsWhateverShortBytesAsThePlainOneDoes) {
  expect_agreement({});
  struct Strings {
    unsigned size;
    std::uint32_t first, end, step;
  };
  // Of three bytes, those whose last is 1: a last byte of 0 is refused at once.
  for (const auto& [size, first, end, step] : {Strings{1, 0, 1 << 8, 1},
                                               {2, 0, 1 << 16, test::sanitized ? 3 : 1},
                                               {3, 1 << 16, 1 << 17, test::sanitized ? 17 : 1}}) {
    for (std::uint32_t value = first; value < end; value += step) {
      std::array<std::byte, 3> bytes;
      for (unsigned i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(value >> 8 * i & 0xff);
      expect_agreement(std::span(bytes).first(size));
      if (HasFatalFailure()) FAIL() << size << " bytes: " << value;
    }
  }
}

TEST(DelimitedReader, GivesBackRandomLists) {
  Random random(1);
  for (int trial = 0; trial < (test::sanitized ? 1000 : 3000); ++trial) {
    Numbers numbers(random.below(300));
    const std::uint32_t bits = 1 + random.below(32), rare = 1 + random.below(40);
    for (auto& number : numbers) {
      const unsigned width = 1 + random.below(random.below(rare) == 0 ? 32 : bits);
      number = std::max(1u, static_cast<std::uint32_t>(random.next() >> (64 - width)));
    }
    expect_round_trip(numbers);
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
}

TEST(DelimitedReader, GivesBackHardLists) {
  std::vector<std::uint32_t> hard = {1,          2,          3,          5,          7,         0x55555555,
                                     0xaaaaaaaa, 0xcccccccc, 0x33333333, 0x77777777, 0xffffffff};
  for (unsigned bits = 3; bits < 32; ++bits)
    hard.insert(hard.end(), {1u << bits, (1u << bits) - 1, (1u << bits) + 1, 5u << (bits - 3)});
  for (const std::uint32_t a : hard) {
    for (const std::uint32_t b : hard) {
      expect_round_trip({a, b});
      expect_round_trip({a, 1, b, 1, 1, a});
    }
    expect_round_trip(Numbers(100, a));
    if (HasFatalFailure()) FAIL() << a;
  }
}

TEST(DelimitedReader,
     FindsEndsOfLongRunsOfOnes) {  // the ones before a number of each kind, at every place of a window
  for (std::size_t ones = 0; ones < 90; ones += test::sanitized ? 3 : 1) {
    for (unsigned shift = 0; shift < 24; ++shift) {
      for (const std::uint32_t before : {2u, 3u, 5u, 7u, 0xfffffffdu, 0xffffffffu}) {
        Numbers numbers = {1u << shift, before};
        numbers.insert(numbers.end(), ones, 1);
        expect_round_trip(numbers);
        numbers.push_back(before);
        numbers.push_back(4);
        expect_round_trip(numbers);
        numbers.erase(numbers.begin(), numbers.begin() + 2);
        expect_round_trip(numbers);
        if (HasFatalFailure()) FAIL() << ones << " ones, shift " << shift;
      }
    }
  }
  expect_round_trip(Numbers(100000, 1));
}

TEST(DelimitedReader, EndsAtEveryBit) {
  Random random(2);
  for (std::size_t count = 1; count < 60; ++count) {
    Numbers numbers(count);
    for (auto& number : numbers) number = 1 + random.below(9);
    for (unsigned bits = 0; bits < 32; ++bits) {
      for (const std::uint32_t last : {1u << bits, 3u << bits, (1u << bits) + 1}) {
        numbers.back() = std::max(1u, last);
        expect_round_trip(numbers);
      }
    }
    if (HasFatalFailure()) FAIL() << count << " numbers";
  }
}

TEST(DelimitedReader, ReadsDamagedListsAsThePlainOneDoes) {
  Random random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    Numbers numbers(1 + random.below(60));
    for (auto& number : numbers)
      number =
          random.below(20) == 0 ? 1 + static_cast<std::uint32_t>(random.next() >> 33) : 1 + random.below(8);
    std::vector<std::byte> bytes = encoded(numbers);
    for (int damage = 0; damage < 20; ++damage) {
      bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] ^=
          static_cast<std::byte>(1u << random.below(8));
      expect_agreement(bytes);
      if (HasFatalFailure()) FAIL() << "trial " << trial;
    }
    const std::size_t left = random.below(static_cast<std::uint32_t>(bytes.size()));
    expect_agreement(std::span(bytes).first(left));
  }
}

TEST(DelimitedReader, ReadsGarbageAsThePlainOneDoes) {
  Random random(4);
  constexpr int trials = test::sanitized ? 25000 : 60000;
  int accepted = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<std::byte> bytes(1 + random.below(40));
    const std::uint32_t density = random.below(4);  // of ones: from a quarter to nearly all
    for (auto& byte : bytes) {
      std::uint64_t bits = random.next();
      if (density == 0) bits &= random.next();
      if (density >= 2) bits |= random.next();
      if (density == 3) bits |= random.next() | random.next();
      byte = static_cast<std::byte>(bits & 0xff);
    }
    bool good = false;
    expect_agreement(bytes, &good);
    if (HasFatalFailure()) FAIL() << "trial " << trial;
    accepted += good;
  }
  EXPECT_GT(accepted, trials / 10);
  EXPECT_LT(accepted, trials / 10 * 9);
}

TEST(DelimitedReader, GivesTheSamePiecesInAnyRoom) {
  Random random(5);
  Numbers numbers(5000);
  for (auto& number : numbers) number = 1 + random.below(1 + random.below(200));
  std::fill_n(numbers.begin() + 1000, 1000, 1);
  const std::vector<std::byte> bytes = encoded(numbers);
  for (const bool way : ways()) {
    for (std::size_t room = DelimitedReader::least_room; room < 200; ++room)
      ASSERT_EQ(decoded(bytes, way, room), numbers);
    EXPECT_EQ(decoded(bytes, way, 10000), numbers);
  }
}

TEST(DelimitedReader, RefusesWithThePlace) {
  const auto refusal = [](const std::vector<std::byte>& bytes) {
    std::set<std::string> words;
    for (const bool way : ways()) {
      try {
        decoded(bytes, way);
        words.insert("accepted");
      } catch (const FormatError& error) {
        words.insert(error.what());
      }
    }
    EXPECT_EQ(words.size(), 1u);
    return *words.begin();
  };
  EXPECT_EQ(refusal({std::byte{7}, std::byte{0}}), "delimiter code: its last byte, 1, is zero");
  EXPECT_EQ(refusal(bytes_of_bits("010")), "delimiter code, bit 0: a number that begins with 0");
  EXPECT_EQ(refusal(bytes_of_bits("1110")), "delimiter code, bit 0: ones of no count that numbers make");
  EXPECT_EQ(refusal(bytes_of_bits("1011011")), "accepted");
  EXPECT_EQ(refusal(bytes_of_bits("10111011")), "accepted");
  EXPECT_EQ(refusal(bytes_of_bits("101")), "delimiter code, bit 4: ones of no count that numbers make");
  const std::string largest = delimited_by_rules(0xffffffff), first_too_large = '1' + std::string(32, '0');
  EXPECT_EQ(refusal(bytes_of_bits("1011" + largest)), "accepted");
  EXPECT_EQ(refusal(bytes_of_bits("1011" + first_too_large)),
            "delimiter code, bit 4: a number above 2^32 - 1");
  EXPECT_EQ(refusal(bytes_of_bits("1011" + first_too_large + "1110")),
            "delimiter code, bit 4: a number above 2^32 - 1");
  EXPECT_EQ(refusal(bytes_of_bits("1011" + first_too_large + "11" + largest + "11" + largest)),
            "delimiter code, bit 4: a number above 2^32 - 1");
  EXPECT_EQ(refusal(bytes_of_bits("10" + std::string(500, '0'))),
            "delimiter code, bit 0: a number above 2^32 - 1");
}

}  // namespace
}  // namespace vismat
