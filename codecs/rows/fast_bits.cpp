// ALGORITHM. Bytes in which rows differ from what they share, for decoders that write bitmaps.
//
// A run of bits, however long, is nothing but the two bytes in which it begins and ends: the leader's words are filled with
// zeros or ones, whichever leave fewer bytes to store. A mask for each word that has any, and a bit for each word that has a
// mask, tell which. The leader is what four consecutive rows are told against, the cheapest of none, each of the rows, and
// what more than half of them have; a row is the leader xor its own bytes.
//
// With AVX-512 one instruction (VPEXPANDB) puts the bytes of eight words in place, so that eight words take 25 instructions;
// otherwise a word takes one deposit of bits (PDEP), or a loop. Where a row's bytes begin is told by two loads, of the part's
// place (a plain index) and of its ends in the part. These come last in the part, so that eight bytes may be read behind any
// row without a question.
//
// The limit (oa_koth1's view cells in the order `best`, 302 bytes a row, 43 of them coded; 2.9 GHz). Bytes are put in place
// in 3 cycles for eight words of each of the two streams, so that a row of five times eight words takes 30 cycles, 10 ns, 29
// GB/s. On a loaded machine, where a copy of a row takes 9 ns, a row takes 34 ns by RowReader in any order, 9 GB/s, and 27
// from memory, of which 2 are its place in the index; checks of blocks, and calls, are the rest. AVX2 takes 125 ns. What is
// left is instructions, some 200 a row: without either expansion a row takes hardly less.
//
// Tried and found larger (bytes of oa_koth1's view cells; faces): leaders of 8 rows, 1.03; 1.04; no leader, 1.21; 1.31 (both
// of rows as changes). Smaller, but no faster: rows and leaders as the places where bits change, .89; .81, whose parities
// are half of the time; leaders whose unstored bytes are as the last bit before them, .96; .97, and 2 ns more. Tried without
// gain in time: masks put in place by PDEP, which needs no store and load; a loop over the eights, 3 ns more.
#include "codecs/rows/fast_bits.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "matrix/base/x86.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;
using u64 = std::uint64_t;
using Words = std::vector<u64>;

std::size_t level_bytes(std::size_t words) {
  return (words + 7) / 8;
}
[[noreturn]] void refuse(const char* what) {
  throw FormatError(std::string("bits of a row or its leader: ") + what);
}
// The lowest `count` bits.
u64 ones(std::size_t count) {
  return count >= 64 ? ~u64{0} : (u64{1} << count) - 1;
}
u64 eight_bytes(const std::byte* at) {
  u64 word;
  std::memcpy(&word, at, 8);
  return word;
}

// Coded bits, cut into their parts; `values` reach to `end`. Eight bytes behind the end can be read. No branch asks whether
// there are any: it would be guessed wrong.
struct Coded {
  const std::byte *levels, *fills, *masks, *values, *end;
  u64 any;  // all ones or none

  // `lists`: 2 if there are fills.
  [[gnu::always_inline]] Coded(Bytes bytes, std::size_t words, std::size_t lists)
      : levels(bytes.data()), end(levels + bytes.size()), any(bytes.empty() ? 0 : ~u64{0}) {
    const std::size_t size = level_bytes(words);
    fills = levels + (size & any);
    masks = levels + (lists * size & any);
    if (masks > end) [[unlikely]]
      refuse("they end within their levels");
    std::size_t present = 0;
    for (std::size_t w = 0; w < words; w += 64)
      present += static_cast<std::size_t>(std::popcount(listed(levels, w, words)));
    values = masks + present;
    if (values > end) [[unlikely]]
      refuse("they end within their masks");
  }
  // The bits of up to 64 words from w on, a multiple of 64, in levels or fills.
  [[gnu::always_inline]] u64 listed(const std::byte* list, std::size_t w, std::size_t words) const {
    const u64 bits = eight_bytes(list + (w / 8 & any)) & ones(8 * level_bytes(words - w)) & any;
    if ((bits & ~ones(words - w)) != 0) [[unlikely]]
      refuse("a word behind the last");
    return bits;
  }
  [[gnu::always_inline]] void expect_no_more() const {
    if (values != end) [[unlikely]]
      refuse("bytes behind the last word");
  }
};

// Plainly and ByAvx2 know the bytes of a word that a mask tells of: all ones there, or there the first ones of `bytes`;
// and whether a branch that asks for a mask costs less than to do without.
struct Plainly {
  static constexpr bool asks = true;
  static u64 all(unsigned mask) {
    const u64 bits = mask * u64{0x0101010101010101} & 0x8040201008040201;  // of byte i bit i
    return ((bits + 0x7f7f7f7f7f7f7f7f) >> 7 & 0x0101010101010101) * 0xff;
  }
  static u64 spread(u64 bytes, unsigned mask) {
    u64 word = 0;
    for (; mask != 0; mask &= mask - 1, bytes >>= 8) word |= (bytes & 0xff) << (8 * std::countr_zero(mask));
    return word;
  }
};

// The masks of eight words, a byte for each, by their bits in `level`.
template <typename How>
[[gnu::always_inline]] inline u64 masks_of_eight(Coded& coded, unsigned level) {
  const u64 masks = How::spread(eight_bytes(coded.masks), level);
  coded.masks += std::popcount(level);
  if (std::popcount(masks) > coded.end - coded.values) [[unlikely]]
    refuse("they end within a word");
  return masks;
}

// The next word's stored bytes.
template <typename How>
[[gnu::always_inline]] inline u64 next_word(Coded& coded, unsigned mask) {
  const u64 word = How::spread(eight_bytes(coded.values), mask);
  coded.values += std::popcount(mask);
  return word;
}

// In all of the following `behind` has the bits of the last word that are behind the last column.
template <typename How>
[[gnu::always_inline]] inline void write_with(Bytes leader_bytes, Bytes own_bytes, std::span<u64> words,
                                              u64 behind) {
  Coded leader(leader_bytes, words.size(), 2), own(own_bytes, words.size(), 1);
  u64 leader_level = 0, own_level = 0, fill = 0;
  for (std::size_t w = 0; w < words.size(); w += 8) {
    if (w % 64 == 0) {
      leader_level = leader.listed(leader.levels, w, words.size());
      own_level = own.listed(own.levels, w, words.size());
      fill = leader.listed(leader.fills, w, words.size());
    }
    u64 leader_masks = masks_of_eight<How>(leader, leader_level & 0xff),
        own_masks = masks_of_eight<How>(own, own_level & 0xff);
    leader_level >>= 8;
    own_level >>= 8;
    const std::size_t end = std::min(words.size(), w + 8);
    for (std::size_t i = w; i < end; ++i) {
      const unsigned leader_mask = leader_masks & 0xff, own_mask = own_masks & 0xff;
      u64 word = (fill >> (i - w) & 1) * ~u64{0};
      if (!How::asks || leader_mask != 0)
        word = (word & ~How::all(leader_mask)) | next_word<How>(leader, leader_mask);
      if (!How::asks || own_mask != 0) word ^= next_word<How>(own, own_mask);
      words[i] = word;
      leader_masks >>= 8;
      own_masks >>= 8;
    }
    fill >>= 8;
  }
  leader.expect_no_more();
  own.expect_no_more();
  if ((words.back() & behind) != 0) refuse("one behind the last column");
}

#if defined(__x86_64__)
struct ByAvx2 {
  static constexpr bool asks = false;
  [[gnu::target("avx2,bmi,bmi2,popcnt")]] static u64 all(unsigned mask) {
    return _pdep_u64(mask, 0x0101010101010101) * 0xff;
  }
  [[gnu::target("avx2,bmi,bmi2,popcnt")]] static u64 spread(u64 bytes, unsigned mask) {
    return _pdep_u64(bytes, all(mask));
  }
};
[[gnu::target("avx2,bmi,bmi2,popcnt")]] void write_avx2(Bytes leader, Bytes own, std::span<u64> words,
                                                        u64 behind) {
  write_with<ByAvx2>(leader, own, words, behind);
}

// The masks of 64 words from w on: a bit for each byte.
struct Masks {
  alignas(64) std::array<u64, 8> bytes;
  [[VISMAT_AVX512, gnu::always_inline]] Masks(Coded& coded, std::size_t w, std::size_t words) {
    const u64 level = coded.listed(coded.levels, w, words);
    _mm512_store_si512(bytes.data(), _mm512_maskz_expandloadu_epi8(level, coded.masks));
    coded.masks += std::popcount(level);
  }
};

// Up to 64 words from w on, eight at a time.
[[VISMAT_AVX512, gnu::always_inline]] inline void write_eights(std::size_t eights, Coded& leader, Coded& own,
                                                               std::size_t w, std::span<u64> words,
                                                               u64 behind) {
  const u64 fill = leader.listed(leader.fills, w, words.size());
  const Masks leader_masks(leader, w, words.size()), own_masks(own, w, words.size());
#pragma GCC unroll 8
  for (std::size_t g = 0; g < eights; ++g) {
    const u64 leader_mask = leader_masks.bytes[g], own_mask = own_masks.bytes[g];
    const std::byte* const leader_next = leader.values + std::popcount(leader_mask);
    const std::byte* const own_next = own.values + std::popcount(own_mask);
    if (leader_next > leader.end || own_next > own.end) [[unlikely]]
      refuse("they end within a word");
    const __m512i filled = _mm512_movm_epi64(static_cast<__mmask8>(fill >> (8 * g))),
                  bits = _mm512_xor_si512(_mm512_mask_expandloadu_epi8(filled, leader_mask, leader.values),
                                          _mm512_maskz_expandloadu_epi8(own_mask, own.values));
    leader.values = leader_next;
    own.values = own_next;
    u64* const to = words.data() + w + 8 * g;
    const std::size_t left = words.size() - w - 8 * g;
    if (left > 8) {
      _mm512_storeu_si512(to, bits);
      continue;
    }
    // The last word is looked at here: a load would wait for the store.
    const auto last = static_cast<__mmask8>(1u << (left - 1));
    if (_mm512_mask_test_epi64_mask(last, bits, _mm512_set1_epi64(static_cast<long long>(behind))) != 0)
        [[unlikely]]
      refuse("one behind the last column");
    _mm512_mask_storeu_epi64(to, static_cast<__mmask8>(2 * last - 1), bits);
  }
}

// Rows of one number of eights: what would be loops is known to be one step, and unrolled.
template <std::size_t eights>
[[VISMAT_AVX512]] void write_narrow(Bytes leader_bytes, Bytes own_bytes, std::span<u64> words, u64 behind) {
  if (words.size() <= 8 * (eights - 1) || words.size() > 8 * eights) __builtin_unreachable();
  Coded leader(leader_bytes, words.size(), 2), own(own_bytes, words.size(), 1);
  write_eights(eights, leader, own, 0, words, behind);
  leader.expect_no_more();
  own.expect_no_more();
}
[[VISMAT_AVX512]] void write_wide(Bytes leader_bytes, Bytes own_bytes, std::span<u64> words, u64 behind) {
  Coded leader(leader_bytes, words.size(), 2), own(own_bytes, words.size(), 1);
  for (std::size_t w = 0; w < words.size(); w += 64)
    write_eights(std::min<std::size_t>(8, level_bytes(words.size() - w)), leader, own, w, words, behind);
  leader.expect_no_more();
  own.expect_no_more();
}

template <std::size_t... i>
constexpr std::array<decltype(&write_wide), 1 + sizeof...(i)> writers_of(std::index_sequence<i...>) {
  return {&write_wide, &write_narrow<1 + i>...};
}
// By the number of eights; from 9 on the first.
constexpr auto writers = writers_of(std::make_index_sequence<8>());
#endif

Words bits_of(std::span<const std::uint32_t> ids, std::uint32_t columns) {
  Words bits((std::size_t{columns} + 63) / 64, 0);
  for (const std::uint32_t id : ids) bits[id / 64] |= u64{1} << (id % 64);
  return bits;
}

u64 byte_of(u64 word, unsigned i) {
  return word >> (8 * i) & 0xff;
}

// The bytes of a word that are not `fill`.
std::uint8_t mask_of(u64 word, u64 fill) {
  std::uint8_t mask = 0;
  for (unsigned i = 0; i < 8; ++i) mask |= static_cast<std::uint8_t>((byte_of(word, i) != fill) << i);
  return mask;
}

// 0 or 0xff, of which the word has more bytes.
u64 fill_of(u64 word) {
  return std::popcount(mask_of(word, 0xff)) < std::popcount(mask_of(word, 0)) ? 0xff : 0;
}

Words operator^(Words a, const Words& b) {
  for (std::size_t w = 0; w < a.size(); ++w) a[w] ^= b[w];
  return a;
}

// The bytes that put() appends.
std::size_t size_of(const Words& bits, bool filled) {
  std::size_t bytes = 0;
  bool any = false;
  for (const u64 word : bits) {
    const int stored = std::popcount(mask_of(word, filled ? fill_of(word) : 0));
    bytes += static_cast<std::size_t>(stored + (stored > 0));
    any |= word != 0;
  }
  return any ? bytes + (filled ? 2 : 1) * level_bytes(bits.size()) : 0;
}

void put(std::vector<std::byte>& out, const Words& bits, bool filled) {
  if (std::ranges::all_of(bits, [](u64 word) { return word == 0; })) return;
  const std::size_t levels = out.size(), lists = filled ? 2 : 1, size = level_bytes(bits.size());
  out.resize(levels + lists * size);
  std::vector<std::byte> values;
  for (std::size_t w = 0; w < bits.size(); ++w) {
    const u64 fill = filled ? fill_of(bits[w]) : 0;
    const std::uint8_t mask = mask_of(bits[w], fill);
    const auto bit = [&](bool is) { return std::byte{is} << (w % 8); };
    out[levels + w / 8] |= bit(mask != 0);
    if (filled) out[levels + size + w / 8] |= bit(fill != 0);
    if (mask != 0) out.push_back(std::byte{mask});
    for (unsigned i = 0; i < 8; ++i) {
      if ((mask >> i & 1) != 0) values.push_back(static_cast<std::byte>(byte_of(bits[w], i)));
    }
  }
  out.insert(out.end(), values.begin(), values.end());
}

// What more than half of the rows have.
Words majority_of(const std::vector<Words>& rows) {
  Words majority(rows.front().size());
  for (std::size_t w = 0; w < majority.size(); ++w) {
    u64 one = 0, two = 0, three = 0;  // that many rows have it
    for (const Words& row : rows) {
      three |= two & row[w];
      two |= one & row[w];
      one |= row[w];
    }
    majority[w] = rows.size() < 2 ? one : rows.size() < 4 ? two : three;
  }
  return majority;
}

}  // namespace

void FastBitRows::encode_part(const VisibilityMatrix& matrix, std::uint32_t first, std::uint32_t end,
                              std::vector<std::byte>& out) const {
  const std::uint32_t columns = matrix.shape().columns;
  const std::size_t bitmap = row_bytes_of(columns), begin = out.size();
  std::vector<Words> rows;
  for (std::uint32_t r = first; r < end; ++r) rows.push_back(bits_of(matrix.row(r), columns));
  // A leader is none, what more than half of the rows have, or a row.
  std::vector<Words> leaders = {bits_of({}, columns), majority_of(rows)};
  leaders.insert(leaders.end(), rows.begin(), rows.end());
  const Words* best = nullptr;
  std::size_t best_bytes = std::numeric_limits<std::size_t>::max();
  for (const Words& leader : leaders) {
    std::size_t bytes = size_of(leader, true);
    if (bytes > 0 && bytes >= bitmap) continue;
    for (const Words& row : rows) bytes += std::min(size_of(row ^ leader, false), bitmap);
    if (bytes < best_bytes) {
      best_bytes = bytes;
      best = &leader;
    }
  }
  std::vector<std::size_t> ends;
  put(out, *best, true);
  ends.push_back(out.size() - begin);
  for (std::uint32_t r = 0; r < rows_per_part; ++r) {
    if (r < rows.size()) {
      const Words own = rows[r] ^ *best;
      if (size_of(own, false) < bitmap)
        put(out, own, false);
      else
        put_bitmap_row(out, matrix.row(first + r), columns);
    }
    ends.push_back(out.size() - begin);
  }
  for (const std::size_t at : ends) {
    for (std::size_t i = 0; i < bytes_of_ends(columns); ++i)
      out.push_back(static_cast<std::byte>(at >> (8 * i) & 0xff));
  }
}

void FastBitRows::write_words(const Streams& streams, std::uint32_t columns, std::span<u64> words) const {
  if (words.empty()) return;
  const u64 behind = columns % 64 == 0 ? 0 : ~u64{0} << (columns % 64);
  switch (simd) {
#if defined(__x86_64__)
    case Simd::avx512: {
      const std::size_t eights = level_bytes(words.size());
      return writers[eights < writers.size() ? eights : 0](streams.leader, streams.own, words, behind);
    }
    case Simd::avx2:
      return write_avx2(streams.leader, streams.own, words, behind);
#endif
    default:
      write_with<Plainly>(streams.leader, streams.own, words, behind);
  }
}

}  // namespace vismat
