// ALGORITHM. Bits where rows change, for decoders that write bitmaps.
//
// A run of ones or zeros, however long, is nothing between its two changes. Few bytes hold changes; a mask for each word
// that has any, and a bit for each word that has a mask, tell which. Four consecutive rows change at much the same places,
// so they are told against a leader: the cheapest of none, each of the rows, and what more than half of them have. A row is
// the leader's changes xor its own, and its bits are the parities of these changes.
//
// With AVX-512 one instruction (VPEXPANDB) puts the bytes of eight words in place, two multiplications without carries and a
// shuffle add up the changes within each word, and the parities of the words are added up as eight bits of a register.
// With AVX2 the words that have changes are made one by one, by PDEP; then all words are added up. The portable code does
// the same byte by byte.
//
// The limit (oa_koth1's view cells in the order `best`, 302 bytes a row, 38 of them coded; 2.9 GHz). Eight words take some
// 35 instructions, 9 cycles: a row of five such groups 45 cycles, 16 ns, 19 GB/s. With AVX-512 a row takes 53 to 57 ns
// from memory to memory, 5.3 to 5.8 GB/s; one of 484 bytes takes 64 to 68, 7.1 to 7.6 GB/s. So each further byte comes at
// 17 GB/s, but each row, however short, costs some 40 ns. It is no wrong guess of branches, for one row again and again
// takes 50 ns. Out of a file 30 ns come for the place in the index. AVX2 takes 83 ns a row, portable code 360.
//
// Tried and found larger (bytes of oa_koth1's view cells; faces): a dictionary of 64-column words under two bits a word
// (zero, ones, an id of 8 or 16 bits), 1.77 times; 1.58; the same with words that occur once in place, 1.61; 1.50; a
// dictionary of changes, 1.75; 1.55; leaders of 2 rows, 1.05; 1.09; of 8 rows, 1.05; 1.05; no leader, 1.22; 1.32. Tried
// without gain in time: loads without a mask, the bytes of all masks counted at once.
#include "codecs/rows/fast_bits.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#if defined(__x86_64__)
#if !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // GCC 12 warns of its own undefined vectors
#endif
#include <immintrin.h>
#if !defined(__clang__)
#pragma GCC diagnostic pop
#endif
#endif

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;
using u64 = std::uint64_t;
using Words = std::vector<u64>;

std::size_t level_bytes(std::size_t words) {
  return (words + 7) / 8;
}
[[noreturn]] void refuse(const std::string& what) {
  throw FormatError("changes of a row: " + what);
}

// The last word with zeros behind its `used` bits. Without changes there they are as the bit before them.
u64 last_word(u64 word, unsigned used) {
  const u64 row = word << (64 - used) >> (64 - used);
  if (const u64 copies = static_cast<u64>(static_cast<std::int64_t>(word << (64 - used)) >> (64 - used));
      word != copies)
    refuse("one behind the last column");
  return row;
}

// Changes, cut into their three parts; `values` reach to `end`.
struct Changes {
  const std::byte *levels, *masks, *values, *end;

  [[gnu::always_inline]] Changes(Bytes bytes, std::size_t words)
      : levels(bytes.data()), masks(levels), values(levels), end(levels + bytes.size()) {
    if (bytes.empty()) return;
    const std::size_t size = level_bytes(words);
    if (bytes.size() < size)
      refuse(std::to_string(bytes.size()) + " bytes; " + std::to_string(words) + " words take " +
             std::to_string(size) + " for their levels");
    if (words % 8 != 0 && std::to_integer<unsigned>(levels[size - 1]) >> (words % 8) != 0)
      refuse("a word behind the last");
    masks = levels + size;
    std::size_t present = 0;
    for (std::size_t w = 0; w < words; w += 64)
      present += static_cast<std::size_t>(std::popcount(level(w, words)));
    if (present > static_cast<std::size_t>(end - masks)) refuse("they end within their masks");
    values = masks + present;
  }
  bool empty() const { return levels == end; }
  // The bits of 64 words from w on, a multiple of 64.
  [[gnu::always_inline]] u64 level(std::size_t w, std::size_t words) const {
    const std::byte* const from = levels + w / 8;
    u64 bits = 0;
    if (end - from >= 8) [[likely]] {
      std::memcpy(&bits, from, 8);
      if (words - w < 64) bits &= (u64{1} << (words - w)) - 1;  // what follows are masks
    } else {
      for (std::size_t i = 0, n = level_bytes(words - w); i < n; ++i)
        bits |= std::to_integer<u64>(from[i]) << (8 * i);
    }
    return bits;
  }
};

// How a word is made of its bytes that have changes, which end at `end`, and how its bits add up: each is the parity of
// the changes up to it. Eight bytes before `end` may be read.
struct Plainly {
  static u64 spread(const std::byte* end, unsigned mask) {
    u64 word = 0;
    const std::byte* byte = end - std::popcount(mask);
    for (; mask != 0; mask &= mask - 1) word |= std::to_integer<u64>(*byte++) << (8 * std::countr_zero(mask));
    return word;
  }
  static u64 parities(u64 word) {
    for (unsigned step = 1; step < 64; step *= 2) word ^= word << step;
    return word;
  }
};

template <typename How>
[[gnu::always_inline]] inline void put_changes(Bytes bytes, std::span<u64> words) {
  const Changes changes(bytes, words.size());
  if (changes.empty()) return;
  const std::byte *masks = changes.masks, *values = changes.values;
  for (std::size_t w = 0; w < words.size(); w += 64) {
    for (u64 level = changes.level(w, words.size()); level != 0; level &= level - 1) {
      const auto mask = std::to_integer<unsigned>(*masks++);
      const int count = std::popcount(mask);
      if (mask == 0 || count > changes.end - values) [[unlikely]]
        refuse("a mask of " + std::to_string(mask));
      values += count;
      words[w + static_cast<unsigned>(std::countr_zero(level))] ^= How::spread(values, mask);
    }
  }
  if (values != changes.end) refuse(std::to_string(changes.end - values) + " bytes behind the last");
}

template <typename How>
[[gnu::always_inline]] inline void add_with(Bytes leader, Bytes own, std::span<u64> words, unsigned used) {
  put_changes<How>(leader, words);
  put_changes<How>(own, words);
  u64 last = 0;  // the last bit so far, in all bits
  for (u64& word : words) {
    word = How::parities(word) ^ last;
    last = static_cast<u64>(static_cast<std::int64_t>(word) >> 63);
  }
  words.back() = last_word(words.back(), used);
}

#if defined(__x86_64__)
struct ByAvx2 {
  [[gnu::target("avx2,bmi,bmi2,popcnt,pclmul")]] static u64 spread(const std::byte* end, unsigned mask) {
    u64 bytes;
    std::memcpy(&bytes, end - 8, 8);
    bytes >>= 64 - 8 * static_cast<unsigned>(std::popcount(mask));
    return _pdep_u64(bytes, _pdep_u64(mask, 0x0101010101010101) * 0xff);
  }
  // A product without carries by ones.
  [[gnu::target("avx2,bmi,bmi2,popcnt,pclmul")]] static u64 parities(u64 word) {
    const __m128i product =
        _mm_clmulepi64_si128(_mm_cvtsi64_si128(static_cast<long long>(word)), _mm_set1_epi8(-1), 0);
    return static_cast<u64>(_mm_cvtsi128_si64(product));
  }
};
[[gnu::target("avx2,bmi,bmi2,popcnt,pclmul")]] void add_avx2(Bytes leader, Bytes own, std::span<u64> words,
                                                             unsigned used) {
  add_with<ByAvx2>(leader, own, words, used);
}

// Changes as add_avx512() reads them. No branch asks whether there are any: it would be guessed wrong.
struct Stream {
  const std::byte *levels, *masks, *values, *end;
  std::size_t level_bytes;
  [[gnu::target("avx512bw,avx512vl,bmi2")]] u64 level(std::size_t word) const {
    const std::size_t left = level_bytes - std::min(level_bytes, word / 8);
    const auto loaded =
        static_cast<__mmask16>(_bzhi_u32(0xff, static_cast<unsigned>(std::min<std::size_t>(left, 8))));
    return static_cast<u64>(_mm_cvtsi128_si64(_mm_maskz_loadu_epi8(loaded, levels + word / 8)));
  }
};
[[gnu::target("avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi2,vpclmulqdq,avx2,bmi,bmi2,popcnt")]] void
add_avx512(Bytes leader, Bytes own, std::span<u64> words, unsigned used) {
  std::array<Stream, 2> both;
  for (std::size_t i = 0; i < 2; ++i) {
    const Bytes bytes = i == 0 ? leader : own;
    Stream& s = both[i];
    const std::size_t size = bytes.empty() ? 0 : level_bytes(words.size());
    if (bytes.size() < size) [[unlikely]]
      refuse("they end within their levels");
    s = {bytes.data(), bytes.data() + size, nullptr, bytes.data() + bytes.size(), size};
    std::int64_t present = 0;
    u64 level = 0;
    for (std::size_t w = 0; w < words.size(); w += 64) {
      level = s.level(w);
      present += std::popcount(level);
    }
    if (present > s.end - s.masks || (words.size() % 64 != 0 && level >> (words.size() % 64) != 0))
        [[unlikely]]
      refuse("they end within their masks, or there is a word behind the last");
    s.values = s.masks + present;
  }
  const __m512i ones = _mm512_set1_epi8(-1);
  u64 last = 0;  // the last bit so far, in eight bits
  for (std::size_t w = 0; w < words.size(); w += 64) {
    alignas(64) std::array<std::array<u64, 8>, 2> masks;  // a bit for each byte of 64 words
    for (std::size_t i = 0; i < 2; ++i) {
      const u64 level = both[i].level(w);
      _mm512_store_si512(masks[i].data(), _mm512_maskz_expandloadu_epi8(level, both[i].masks));
      both[i].masks += std::popcount(level);
    }
    for (std::size_t g = 0; g < 8 && w + 8 * g < words.size(); ++g) {
      __m512i changes = _mm512_setzero_si512();
      for (std::size_t i = 0; i < 2; ++i) {
        const u64 mask = masks[i][g];
        if (std::popcount(mask) > both[i].end - both[i].values) [[unlikely]]
          refuse("they end within a word");
        changes = _mm512_xor_si512(changes, _mm512_maskz_expandloadu_epi8(mask, both[i].values));
        both[i].values += std::popcount(mask);
      }
      // Parities by a product without carries by ones; then words behind an odd number of changes are flipped.
      __m512i bits = _mm512_unpacklo_epi64(_mm512_clmulepi64_epi128(changes, ones, 0),
                                           _mm512_clmulepi64_epi128(changes, ones, 1));
      u64 odd = _mm512_movepi64_mask(bits);
      for (unsigned step = 1; step < 8; step *= 2) odd ^= odd << step;
      bits = _mm512_mask_xor_epi64(bits, static_cast<__mmask8>(odd << 1 ^ last), bits, ones);
      last ^= (odd >> 7 & 1) * 0xff;
      const std::size_t left = words.size() - w - 8 * g;
      if (left <= 8) {  // the last word is looked at here: a load would wait for the store
        const auto at = static_cast<__mmask8>(1u << (left - 1));
        const u64 word = static_cast<u64>(
            _mm_cvtsi128_si64(_mm512_castsi512_si128(_mm512_maskz_compress_epi64(at, bits))));
        bits = _mm512_mask_set1_epi64(bits, at, static_cast<long long>(last_word(word, used)));
      }
      _mm512_mask_storeu_epi64(words.data() + w + 8 * g,
                               static_cast<__mmask8>(left >= 8 ? 0xff : (1u << left) - 1), bits);
    }
  }
  for (const Stream& changes : both) {
    if (changes.values != changes.end)
      refuse(std::to_string(changes.end - changes.values) + " bytes behind the last");
  }
}
#endif

Words changes_of(std::span<const std::uint32_t> ids, std::uint32_t columns) {
  Words bits((std::size_t{columns} + 63) / 64, 0);
  for (const std::uint32_t id : ids) bits[id / 64] |= u64{1} << (id % 64);
  u64 last = 0;
  for (u64& word : bits) word ^= word << 1 | std::exchange(last, word >> 63);
  if (columns % 64 != 0) bits.back() &= ~u64{0} >> (64 - columns % 64);
  return bits;
}

std::uint8_t bytes_with_changes(u64 word) {
  std::uint8_t mask = 0;
  for (unsigned i = 0; i < 8; ++i) mask |= static_cast<std::uint8_t>(((word >> (8 * i) & 0xff) != 0) << i);
  return mask;
}

std::size_t size_of(const Words& a, const Words& b) {  // of the changes in which they differ
  std::size_t words = 0, bytes = 0;
  for (std::size_t w = 0; w < a.size(); ++w) {
    const u64 word = a[w] ^ b[w];
    words += word != 0;
    bytes += static_cast<std::size_t>(std::popcount(bytes_with_changes(word)));
  }
  return words == 0 ? 0 : level_bytes(a.size()) + words + bytes;
}

void put(std::vector<std::byte>& out, const Words& a, const Words& b) {
  if (a == b) return;
  const std::size_t levels = out.size();
  out.resize(levels + level_bytes(a.size()));
  for (std::size_t w = 0; w < a.size(); ++w) {
    if (a[w] == b[w]) continue;
    out[levels + w / 8] |= std::byte{1} << (w % 8);
    out.push_back(std::byte{bytes_with_changes(a[w] ^ b[w])});
  }
  for (std::size_t w = 0; w < a.size(); ++w) {
    for (unsigned i = 0; i < 8; ++i) {
      if (const u64 byte = (a[w] ^ b[w]) >> (8 * i) & 0xff; byte != 0)
        out.push_back(static_cast<std::byte>(byte));
    }
  }
}

}  // namespace

void FastBitRows::encode_part(const VisibilityMatrix& matrix, std::uint32_t first, std::uint32_t end,
                              std::vector<std::byte>& out) const {
  const std::uint32_t columns = matrix.shape().columns;
  const std::size_t words = (std::size_t{columns} + 63) / 64, bitmap = row_bytes_of(columns);
  std::vector<Words> rows;
  for (std::uint32_t r = first; r < end; ++r) rows.push_back(changes_of(matrix.row(r), columns));
  const auto size_of_row = [&](const Words& row, const Words& leader) {
    return std::min(size_of(row, leader), bitmap);
  };
  // A leader is none, a row, or what more than half of the rows have.
  const Words none(words, 0);
  Words majority = none;
  for (std::size_t w = 0; w < words; ++w) {
    u64 one = 0, two = 0, three = 0;  // that many rows have it
    for (const Words& row : rows) {
      three |= two & row[w];
      two |= one & row[w];
      one |= row[w];
    }
    majority[w] = rows.size() < 2 ? one : rows.size() < 4 ? two : three;
  }
  std::vector<const Words*> leaders = {&none, &majority};
  for (const Words& row : rows) leaders.push_back(&row);
  const Words* best = nullptr;
  std::size_t best_bytes = std::numeric_limits<std::size_t>::max();
  for (const Words* const leader : leaders) {
    const std::size_t own = size_of(*leader, none);
    if (own > 0 && own >= bitmap) continue;
    std::size_t bytes = own + varint_bytes(own);
    for (const Words& row : rows) {
      const std::size_t size = size_of_row(row, *leader);
      bytes += size + varint_bytes(size);
    }
    if (bytes < best_bytes) {
      best_bytes = bytes;
      best = leader;
    }
  }
  put_varint(out, size_of(*best, none));
  for (std::size_t r = 0; r < rows_per_part; ++r)
    put_varint(out, r < rows.size() ? size_of_row(rows[r], *best) : 0);
  put(out, *best, none);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (size_of(rows[r], *best) < bitmap)
      put(out, rows[r], *best);
    else
      put_bitmap_row(out, matrix.row(first + static_cast<std::uint32_t>(r)), columns);
  }
}

FastBitRows::Streams FastBitRows::streams_of(Bytes part, std::uint32_t row, std::uint32_t columns) {
  std::array<u64, 1 + rows_per_part> sizes;
  std::size_t at = sizes.size();
  bool one_byte_each = part.size() >= at;
  if (one_byte_each) {
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      sizes[i] = std::to_integer<u64>(part[i]);
      one_byte_each &= sizes[i] < 0x80;
    }
  }
  if (!one_byte_each) {
    ByteReader in(part, "four rows");
    for (u64& size : sizes) size = in.varint();
    at = in.offset();
  }
  const std::size_t bitmap = row_bytes_of(columns);
  u64 all = 0, before = 0, most = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    before += i <= row ? sizes[i] : 0;
    all += sizes[i];
    most = std::max(most, sizes[i]);
  }
  if (most > bitmap || (sizes[0] == bitmap && bitmap > 0)) [[unlikely]]
    refuse(std::to_string(most) + " bytes; the bitmap of a row has " + std::to_string(bitmap));
  if (all != part.size() - at) [[unlikely]]
    refuse(std::to_string(part.size() - at) + " bytes of rows, not the " + std::to_string(all) +
           " announced");
  const Bytes rest = part.subspan(at);
  return {rest.first(sizes[0]), rest.subspan(before, sizes[row + 1]), sizes[row + 1] == bitmap};
}

void FastBitRows::add_changes(const Streams& streams, std::uint32_t columns, std::span<u64> words) const {
  if (words.empty()) return;
  const unsigned used = (columns - 1) % 64 + 1;
  switch (simd) {
#if defined(__x86_64__)
    case Simd::avx512:
      return add_avx512(streams.leader, streams.own, words, used);
    case Simd::avx2:
      return add_avx2(streams.leader, streams.own, words, used);
#endif
    default:
      add_with<Plainly>(streams.leader, streams.own, words, used);
  }
}

}  // namespace vismat
