#include "codecs/vmat/part_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "matrix/base/random.h"
#include "tests/simd_here.h"

namespace vismat {
namespace {

using Piece = std::span<const std::byte>;
constexpr auto as_is = [](Piece bytes) { return bytes; };

void expect_reads_back(const std::vector<std::uint64_t>& starts, std::uint64_t payload_bytes,
                       IndexForm form) {
  const auto bytes = part_index_bytes(starts, payload_bytes, form);
  for (const Simd simd : test::simd_here()) {
    const PartIndex index(bytes, payload_bytes, as_is, simd);
    index.check_whole();
    ASSERT_EQ(index.parts(), starts.size());
    EXPECT_EQ(index.model_bytes(as_is), starts.empty() ? payload_bytes : starts[0]);
    for (std::uint64_t i = 0; i < starts.size(); ++i) {
      const auto [begin, end] = index.part(i, as_is);
      ASSERT_EQ(begin, starts[i]) << i << " of " << starts.size() << " in " << payload_bytes;
      ASSERT_EQ(end, i + 1 < starts.size() ? starts[i + 1] : payload_bytes)
          << i << " of " << starts.size() << " in " << payload_bytes;
    }
  }
}

void expect_reads_back(const std::vector<std::uint64_t>& starts, std::uint64_t payload_bytes) {
  for (const IndexForm form : {IndexForm::small, IndexForm::plain})
    expect_reads_back(starts, payload_bytes, form);
}

// What part() reads it has announced: a byte that is read before its block's checksum may be damaged.
TEST(PartIndex, AnnouncesAllThatItReads) {
  std::vector<std::uint64_t> starts(2000);
  Random random(4);
  for (std::size_t i = 1; i < starts.size(); ++i) starts[i] = starts[i - 1] + random.below(300);
  const std::uint64_t all = starts.back() + 7;
  for (const IndexForm form : {IndexForm::small, IndexForm::plain}) {
    const auto bytes = part_index_bytes(starts, all, form);
    for (const Simd simd : test::simd_here()) {
      const PartIndex plain(bytes, all, as_is, simd);
      for (std::uint64_t i = 0; i < starts.size(); i += 37) {
        std::vector<Piece> announced;
        plain.part(i, [&](Piece piece) { return announced.emplace_back(piece); });
        std::vector<std::byte> other(bytes.size());
        for (std::size_t b = 0; b < bytes.size(); ++b) other[b] = ~bytes[b];
        for (std::size_t b = 0; b < std::min<std::size_t>(bytes.size(), 10); ++b) other[b] = bytes[b];
        for (const Piece piece : announced)
          std::ranges::copy(piece, other.begin() + (piece.data() - bytes.data()));
        const auto [begin, end] = PartIndex(other, all, as_is, simd).part(i, as_is);
        EXPECT_EQ(begin, starts[i]);
        EXPECT_EQ(end, i + 1 < starts.size() ? starts[i + 1] : all);
      }
    }
  }
}

TEST(PartIndex, ReadsEveryPlace) {
  Random random(1);
  for (const std::uint64_t count : {0, 1, 2, 3, 63, 64, 65, 255, 256, 257, 511, 512, 513, 1000}) {
    for (const std::uint64_t largest :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{63}, std::uint64_t{1000}, std::uint64_t{1} << 20,
          std::uint64_t{1} << 40, std::uint64_t{1} << 62}) {
      std::vector<std::uint64_t> starts(count);
      for (auto& n : starts)
        n = (std::uint64_t{random.below(1u << 31)} << 31 | random.below(1u << 31)) % (largest + 1);
      std::sort(starts.begin(), starts.end());
      expect_reads_back(starts, largest);
      std::fill(starts.begin(), starts.end(), largest);
      expect_reads_back(starts, largest);
      std::fill(starts.begin(), starts.end(), 0);
      if (count > 0) starts.back() = largest;  // one gap over all the words
      expect_reads_back(starts, largest);
    }
  }
}

TEST(PartIndex, TellsEqualPartsByTheirNumber) {
  for (const std::uint64_t bytes : {0, 1, 7}) {
    std::vector<std::uint64_t> starts(1000);
    for (std::uint64_t i = 0; i < starts.size(); ++i) starts[i] = i * bytes;
    EXPECT_EQ(part_index_bytes(starts, 1000 * bytes).size(), 2u);
    expect_reads_back(starts, 1000 * bytes);
  }
}

// Elias and Fano's bound is 2 + log2(bytes / parts) bits a part; of rows that take less than two bytes, one and these bytes.
TEST(PartIndex, TakesLittleMoreThanTheBound) {
  Random random(2);
  for (const double mean : {.3, 1., 1.9, 5., 100., 3000.}) {
    std::vector<std::uint64_t> starts(20000);
    std::uint64_t at = 0;
    for (auto& start : starts) {
      start = at;
      at += static_cast<std::uint64_t>(-std::log(1 - random.fraction()) * mean + .5);
    }
    const double u = static_cast<double>(at) / 20000, bound = u < 2 ? 1 + u : 2 + std::log2(u);
    const double bits = 8 * static_cast<double>(part_index_bytes(starts, at).size()) / 20000;
    EXPECT_LT(bits, bound + .15) << mean;
  }
}

TEST(PartIndex, APlainOneHasFourBytesForAPlace) {
  EXPECT_EQ(part_index_bytes(std::vector<std::uint64_t>{1, 5, 7}, 70, IndexForm::plain).size(), 1u + 4 * 4);
  EXPECT_EQ(part_index_bytes(std::vector<std::uint64_t>{0, 7}, 14, IndexForm::plain).size(), 1u);
}

TEST(PartIndex, RefusesAnotherSize) {
  const std::vector<std::uint64_t> starts = {1, 5, 7};
  for (const IndexForm form : {IndexForm::small, IndexForm::plain}) {
    const auto bytes = part_index_bytes(starts, 70, form);
    const std::size_t least = form == IndexForm::plain ? 2 : 0;  // a byte 0 alone tells of no parts
    for (std::size_t n = least; n < bytes.size(); ++n)
      EXPECT_THROW(PartIndex(std::span(bytes).first(n), 70, as_is).check_whole(), FormatError) << n;
    auto longer = bytes;
    longer.push_back(std::byte{0});
    EXPECT_THROW(PartIndex(longer, 70, as_is), FormatError);
    EXPECT_THROW(PartIndex(bytes, 7000, as_is).check_whole(), FormatError);
  }
}

TEST(PartIndex, TellsWhatItReadsAndReadsNothingElse) {
  std::vector<std::uint64_t> starts(5000);
  for (std::uint64_t i = 0; i < starts.size(); ++i) starts[i] = i * i;
  const std::uint64_t payload_bytes = starts.back() + 99;
  const auto bytes = part_index_bytes(starts, payload_bytes);
  const PartIndex index(bytes, payload_bytes, as_is);
  for (const std::uint64_t i : {0, 777, 4999}) {
    std::vector<std::byte> alone(bytes.size(), std::byte{0xa5});  // other bytes are overwritten
    const auto copy = [&](Piece part) {
      std::copy(part.begin(), part.end(), alone.begin() + (part.data() - bytes.data()));
      return part;
    };
    const auto truth = PartIndex(bytes, payload_bytes, copy).part(i, copy);
    const auto found = PartIndex(alone, payload_bytes, as_is).part(i, as_is);
    EXPECT_EQ(found.begin, truth.begin);
    EXPECT_EQ(found.end, truth.end);
  }
}

TEST(PartIndex, StaysInsideDamagedBytes) {
  Random random(2);
  std::vector<std::uint64_t> starts(600);
  for (std::uint64_t i = 0; i < starts.size(); ++i) starts[i] = 1000 + i * 7;
  for (int trial = 0; trial < 2000; ++trial) {
    auto bad = part_index_bytes(starts, 9000, trial % 2 == 0 ? IndexForm::small : IndexForm::plain);
    for (int flip = 0; flip < 3; ++flip)
      bad[random.below(static_cast<std::uint32_t>(bad.size()))] = static_cast<std::byte>(random.below(256));
    try {
      const PartIndex index(bad, 9000, as_is);
      for (std::uint64_t i = 0; i < index.parts(); ++i) {
        try {
          const auto [begin, end] = index.part(i, as_is);
          ASSERT_LE(begin, end);
          ASSERT_LE(end, 9000u);
        } catch (const FormatError&) {
        }
      }
      index.check_whole();  // refuses, or takes it for another list of places
    } catch (const FormatError&) {
    }
  }
}

}  // namespace
}  // namespace vismat
