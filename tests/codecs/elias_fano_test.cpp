#include "codecs/elias_fano.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "matrix/random.h"

namespace vismat {
namespace {

constexpr auto anywhere = [](std::uint64_t, std::uint64_t) {};

void expect_reads_back(const std::vector<std::uint64_t>& numbers, std::uint64_t largest) {
  const auto bytes = elias_fano_bytes(numbers, largest);
  const EliasFano list(bytes, numbers.size(), largest);
  for (std::uint64_t i = 0; i + 1 < numbers.size(); ++i) {
    const auto [first, second] = list.pair(i, anywhere);
    ASSERT_EQ(first, numbers[i]) << i << " of " << numbers.size() << " up to " << largest;
    ASSERT_EQ(second, numbers[i + 1]) << i << " of " << numbers.size() << " up to " << largest;
  }
}

TEST(EliasFano, ReadsEveryPair) {
  Random random(1);
  for (const std::uint64_t count : {0, 1, 2, 3, 63, 64, 65, 127, 128, 129, 1000}) {
    for (const std::uint64_t largest :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{63}, std::uint64_t{1000}, std::uint64_t{1} << 20,
          std::uint64_t{1} << 40, std::uint64_t{1} << 62}) {
      std::vector<std::uint64_t> numbers(count);
      for (auto& n : numbers)
        n = (std::uint64_t{random.below(1u << 31)} << 31 | random.below(1u << 31)) % (largest + 1);
      std::sort(numbers.begin(), numbers.end());
      expect_reads_back(numbers, largest);
      std::fill(numbers.begin(), numbers.end(), largest);
      expect_reads_back(numbers, largest);
      std::fill(numbers.begin(), numbers.end(), 0);
      if (count > 0) numbers.back() = largest;  // one gap over all the words
      expect_reads_back(numbers, largest);
    }
  }
}

TEST(EliasFano, TakesTwoBitsAndTheLogarithm) {
  std::vector<std::uint64_t> numbers(10000);
  for (std::uint64_t i = 0; i < numbers.size(); ++i) numbers[i] = i * 100;
  const auto bytes = elias_fano_bytes(numbers, 1000000);
  // 6 low bits, 1 + 100 / 64 high ones, 1 of the samples; log2(100) = 6.64
  EXPECT_LT(static_cast<double>(bytes.size()) * 8 / 10000, 6 + 2.57 + 1 + .02);
}

TEST(EliasFano, RefusesAnotherSize) {
  const auto bytes = elias_fano_bytes(std::vector<std::uint64_t>{1, 5, 7}, 7);
  EXPECT_THROW(EliasFano(std::span(bytes).first(bytes.size() - 1), 3, 7), FormatError);
  EXPECT_THROW(EliasFano(bytes, 300, 7), FormatError);
}

TEST(EliasFano, TellsWhatItReadsAndReadsNothingElse) {
  std::vector<std::uint64_t> numbers(5000);
  for (std::uint64_t i = 0; i < numbers.size(); ++i) numbers[i] = i * i;
  const auto bytes = elias_fano_bytes(numbers, numbers.back());
  const EliasFano list(bytes, numbers.size(), numbers.back());
  for (const std::uint64_t i : {std::uint64_t{0}, std::uint64_t{777}, std::uint64_t{4998}}) {
    std::vector<std::byte> alone(bytes.size(), std::byte{0xa5});  // other bytes are overwritten
    const auto copy = [&](std::uint64_t offset, std::uint64_t size) {
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), size,
                  alone.begin() + static_cast<std::ptrdiff_t>(offset));
    };
    const auto truth = list.pair(i, copy);
    EXPECT_EQ(EliasFano(alone, numbers.size(), numbers.back()).pair(i, anywhere), truth);
  }
}

TEST(EliasFano, StaysInsideDamagedBytes) {
  Random random(2);
  std::vector<std::uint64_t> numbers(300);
  std::iota(numbers.begin(), numbers.end(), 1000);
  const auto good = elias_fano_bytes(numbers, 5000);
  for (int trial = 0; trial < 2000; ++trial) {
    auto bad = good;
    for (int flip = 0; flip < 3; ++flip)
      bad[random.below(static_cast<std::uint32_t>(bad.size()))] = static_cast<std::byte>(random.below(256));
    const EliasFano list(bad, numbers.size(), 5000);
    for (std::uint64_t i = 0; i + 1 < numbers.size(); ++i) {
      try {
        list.pair(i, anywhere);
      } catch (const FormatError&) {
      }
    }
  }
}

}  // namespace
}  // namespace vismat
