// ALGORITHM. Runs of ids in whole bytes, for decoders that write ids.
//
// A run is a token of one byte, which names its gap and its length, and raw bytes if they are rare. Tokens and raw bytes
// lie apart, tokens from the row's end backwards, so that neither must wait for the other: what is carried from run to
// run is the place among the raw bytes, and the column, by one addition each. A class is a base and a mask, so no branch
// asks what kind it is. Both ways meet where the row ends, which is why no number of runs is stored. The 32 classes are
// 512 bytes, which a cold decoder loads from memory.
//
// With AVX-512 sixteen runs are decoded at once: their classes are looked up in registers, one instruction (VPEXPANDB) puts
// the raw bytes of eight gaps and lengths into place, and running sums give where each run begins. Then 64 ids are written
// for a run whatever its length, so that only longer ones are guessed wrong. Numbers from 2^25 on and damaged rows are left
// to the other way, run by run, where IdSink::runs writes 32 ids at once.
//
// The limit (oa_koth1's view cells in the order `best`, 22 runs and 409 ids a row; 2.9 GHz). 37 bytes are read and 1.6 kB
// written. Four stores of 64 bytes for each run, which cross lines of the cache, take 10 cycles: 76 ns a row. Two batches of
// sixteen take some 130 instructions, 12 ns. In a loop over rows in memory a row takes 117 ns in any order and 106 in
// sequence, run by run 149 and 138; by RowReader 146 and 137 (before it had a plain index 318 and 293) while a copy of the
// same ids takes 85 and 79.
//
// Tried and found larger or slower: pairs of bytes (gap, length), longer ones as several pairs, +30 %; a row equal to the
// one before stored once, in groups of 8 rows, -1 % on view cells and faces and +2 % on differences; raw bytes behind each
// token, which are found one after the other. Run by run, 8 or 16 ids at once, 1.2 to 1.6 times the time, and 64, the same.
// By sixteen runs, with ids written 32 at once, 1.3 times the time, 48, 1.07; stores of 32 bytes, 1.16; stores behind a
// run's end masked, 1.5 to 2.1; what is longer written after all 16 runs, 1.1 to 1.2.
#include "codecs/rows/fast_ids.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "matrix/base/x86.h"

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
  rows.fill_tables();
  return rows;
}

namespace {

// Numbers from here on are left to the other ways, so that sums of 32 stay small.
constexpr std::uint32_t large = 1u << 25;

}  // namespace

void FastIdRows::fill_tables() {
  for (unsigned k = 0; k < 16; ++k) {
    const auto fill = [&](Tables::Of& of, const Class& c, unsigned shift, unsigned token_bytes) {
      of.bases[k] = static_cast<std::uint32_t>(std::min<std::uint64_t>(c.base, large));
      of.masks[k] = static_cast<std::uint8_t>(((1u << c.bytes) - 1) << shift);
      of.bytes[k] = static_cast<std::uint8_t>(c.bytes + token_bytes);
    };
    fill(tables_.gaps, gaps_[k], 0, 1);
    fill(tables_.lengths, lengths_[k], 4, 0);
  }
}

#if defined(__x86_64__)
namespace {

using Numbers = __m512i;  // 16 of 32 bits

// The sums of the numbers up to each.
[[VISMAT_AVX512, gnu::always_inline]] inline Numbers sums(Numbers n) {
  const Numbers none = _mm512_setzero_si512();
  n = _mm512_add_epi32(n, _mm512_alignr_epi32(n, none, 15));
  n = _mm512_add_epi32(n, _mm512_alignr_epi32(n, none, 14));
  n = _mm512_add_epi32(n, _mm512_alignr_epi32(n, none, 12));
  return _mm512_add_epi32(n, _mm512_alignr_epi32(n, none, 8));
}
[[VISMAT_AVX512, gnu::always_inline]] inline __m128i sums_of_bytes(__m128i n) {
  n = _mm_add_epi8(n, _mm_bslli_si128(n, 1));
  n = _mm_add_epi8(n, _mm_bslli_si128(n, 2));
  n = _mm_add_epi8(n, _mm_bslli_si128(n, 4));
  return _mm_add_epi8(n, _mm_bslli_si128(n, 8));
}
[[VISMAT_AVX512, gnu::always_inline]] inline Numbers all(std::uint32_t number) {
  return _mm512_set1_epi32(static_cast<int>(number));
}
template <typename T>
[[VISMAT_AVX512, gnu::always_inline]] inline __m128i load16(const std::array<T, 16>& bytes) {
  return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes.data()));
}

}  // namespace

// Sixteen runs at a time.
[[VISMAT_AVX512]] bool FastIdRows::decode_avx512(std::span<const std::byte> bytes, IdSink& sink) const {
  constexpr std::size_t at_once = 64;
  const Numbers ascending = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0),
                even = _mm512_add_epi32(ascending, ascending), odd = _mm512_or_si512(even, all(1));
  const __m128i backwards = _mm_set_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                low_half = _mm_set1_epi8(15);
  const __m128i gap_masks = load16(tables_.gaps.masks), length_masks = load16(tables_.lengths.masks),
                gap_bytes = load16(tables_.gaps.bytes), length_bytes = load16(tables_.lengths.bytes);
  const Numbers gap_bases = _mm512_load_si512(tables_.gaps.bases.data()),
                length_bases = _mm512_load_si512(tables_.lengths.bases.data());
  const std::uint32_t columns = sink.columns();
  if (columns >> 31 != 0) return false;
  const std::byte *raw = bytes.data(), *code = raw + bytes.size();
  std::uint32_t *begin = sink.room(0, 0), *at = begin;
  const std::uint32_t* end = sink.room_end();
  std::uint32_t before = 0;  // the column behind the last run
  Numbers place = all(~0u);  // the same; as the first gap is one more, first the one before it
  while (raw < code) {
    const auto left = static_cast<std::size_t>(code - raw);
    const auto there = static_cast<__mmask16>(left >= 16 ? 0xffff : 0xffff << (16 - left));
    const __m128i tokens = _mm_shuffle_epi8(_mm_maskz_loadu_epi8(there, code - 16), backwards),
                  gap_class = _mm_and_si128(tokens, low_half),
                  length_class = _mm_and_si128(_mm_srli_epi16(tokens, 4), low_half);
    // Tokens end where raw bytes of the runs before begin.
    const __m128i taken = _mm_add_epi8(_mm_shuffle_epi8(gap_bytes, gap_class),
                                       _mm_shuffle_epi8(length_bytes, length_class)),
                  taken_before = _mm_sub_epi8(sums_of_bytes(taken), taken);
    const __mmask16 runs =
        _mm_cmplt_epu8_mask(taken_before, _mm_set1_epi8(static_cast<char>(std::min<std::size_t>(left, 255))));
    const auto count = static_cast<std::size_t>(std::popcount(static_cast<unsigned>(runs)));
    const __m128i masks = _mm_maskz_mov_epi8(
        runs,
        _mm_or_si128(_mm_shuffle_epi8(gap_masks, gap_class), _mm_shuffle_epi8(length_masks, length_class)));
    const auto masks_0 = static_cast<std::uint64_t>(_mm_cvtsi128_si64(masks)),
               masks_1 = static_cast<std::uint64_t>(_mm_extract_epi64(masks, 1));
    const int raw_0 = std::popcount(masks_0), raw_1 = std::popcount(masks_1);
    if (static_cast<std::size_t>(raw_0 + raw_1) + count > left) [[unlikely]]
      return false;
    // The raw bytes of a gap and of a length go into four bytes each.
    const Numbers raw_of_0 = _mm512_maskz_expandloadu_epi8(masks_0, raw),
                  raw_of_1 = _mm512_maskz_expandloadu_epi8(masks_1, raw + raw_0),
                  raw_gaps = _mm512_permutex2var_epi32(raw_of_0, even, raw_of_1),
                  raw_lengths = _mm512_permutex2var_epi32(raw_of_0, odd, raw_of_1),
                  classes = _mm512_cvtepu8_epi32(tokens);  // a permutation looks at four bits
    raw += raw_0 + raw_1;
    code -= count;
    const Numbers gaps = _mm512_maskz_add_epi32(runs, raw_gaps, _mm512_permutexvar_epi32(classes, gap_bases)),
                  lengths = _mm512_maskz_add_epi32(
                      runs, raw_lengths,
                      _mm512_permutexvar_epi32(_mm512_srli_epi32(classes, 4), length_bases));
    const Numbers bits =
        _mm512_or_si512(_mm512_or_si512(gaps, lengths), _mm512_or_si512(raw_gaps, raw_lengths));
    if (_mm512_cmpge_epu32_mask(bits, all(large)) != 0) [[unlikely]]
      return false;
    const Numbers ends = _mm512_add_epi32(sums(_mm512_add_epi32(gaps, lengths)), place);
    place = _mm512_permutexvar_epi32(all(15), ends);
    const auto behind = static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm512_castsi512_si128(place)));
    if (behind > columns) [[unlikely]]
      return false;
    if (static_cast<std::size_t>(end - at) < behind - before + at_once) [[unlikely]] {
      const auto ids = static_cast<std::uint32_t>(_mm512_reduce_add_epi32(lengths));
      const auto written = static_cast<std::size_t>(at - begin);
      begin = sink.room(written, ids + at_once);
      at = begin + written;
      end = sink.room_end();
    }
    before = behind;
    alignas(64) std::array<std::uint32_t, 16> firsts, counts;
    _mm512_store_si512(firsts.data(), _mm512_sub_epi32(ends, lengths));
    _mm512_store_si512(counts.data(), lengths);
    for (std::size_t i = 0; i < count; ++i) {
      Numbers ids = _mm512_add_epi32(all(firsts[i]), ascending);
      std::uint32_t* to = at;
      at += counts[i];
      for (;;) {
#pragma GCC unroll 4
        for (std::uint32_t j = 0; j < at_once; j += 16)
          _mm512_storeu_si512(to + j, _mm512_add_epi32(ids, all(j)));
        to += at_once;
        if (to >= at) break;
        ids = _mm512_add_epi32(ids, all(at_once));
      }
    }
    if (count < 16) break;
  }
  if (raw != code) return false;
  sink.wrote(static_cast<std::size_t>(at - begin), before);
  return true;
}
#endif

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
