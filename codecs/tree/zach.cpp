// ALGORITHM [Zach & Karner 2003, sections 4.4 and 5]. The codecs `zach...`: the paper's five methods for one node's
// children. m is the number of view cells that see the node, k that of its children, and B_i are the bits of child i.
//
//   zach0  the bits as they are: k m.
//   zach1  the intersection of all B_i (m bits), then each B_i outside it. [Gotsman et al. 1999]
//   zach2  the same for a subset S of the children, the others as in zach0; k bits name S. The paper
//          prints the intersection's cost as its number of ones, but a decoder needs m bits for it (and the
//          published sizes of method 1 are above those of method 0, which only m bits explain), so we minimize
//          m + |S| (m - ones) + (k - |S|) m. Up to 10 children every subset is tried, beyond that, of each
//          size, the densest children.
//   zach3  all bits in a row, child after child; lengths of alternating runs, entropy coded.
//   zach4  the same bits, of which zeros are the rarer: the number of ones before each zero, entropy coded, after
//          van de Panne & Stewart's sparse coding with the two values exchanged.
//
// Lengths are coded by run_length_symbols.h. "-huffman" is a canonical Huffman code for all nodes, in zach3 one for
// runs of zeros and one for runs of ones; "-range" replaces it by arithmetic coding, which the paper only calculated.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/huffman.h"
#include "codecs/entropy/range_coder.h"
#include "codecs/entropy/run_length_symbols.h"
#include "codecs/tree/tree_coding.h"

namespace vismat {
namespace {

// --- zach0, zach1, zach2: bits
// ------------------------------------------------------------------------------

// The bits of every child in the set `chosen` (one flag a child): their intersection, then each outside it.
void put_with_intersection(BitWriter& out, const ChildBits& node, const std::vector<bool>& chosen) {
  std::vector<std::uint8_t> common(node.members, 1);
  for (std::uint32_t i = 0; i < node.children; ++i) {
    for (std::uint32_t p = 0; chosen[i] && p < node.members; ++p)
      common[p] &= node.bits[std::size_t{i} * node.members + p];
  }
  put_bits(out, common);
  std::vector<std::uint8_t> outside(node.members);
  for (std::uint32_t i = 0; i < node.children; ++i) {
    const std::uint8_t* const bits = node.bits.data() + std::size_t{i} * node.members;
    std::size_t count = 0;
    for (std::uint32_t p = 0; p < node.members; ++p) {
      outside[count] = bits[p];
      count += !chosen[i] || !common[p];
    }
    put_bits(out, std::span(outside).first(count));
  }
}

void get_with_intersection(BitReader& in, ChildBits& node, const std::vector<bool>& chosen) {
  std::vector<std::uint8_t> common(node.members);
  get_bits(in, common);
  for (std::uint32_t i = 0; i < node.children; ++i) {
    for (std::uint32_t p = 0; p < node.members; ++p) {
      node.bits[std::size_t{i} * node.members + p] =
          chosen[i] && common[p] ? 1 : static_cast<std::uint8_t>(in.get(1));
    }
  }
}

class PlainBits : public NodeCoder {
 public:
  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    BitWriter bits(out);
    put_bits(bits, node.bits);
    bits.flush();
  }
  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    BitReader in(part);
    get_bits(in, node.bits);
    in.finish();
  }
};

class AllIntersected : public NodeCoder {
 public:
  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    BitWriter bits(out);
    put_with_intersection(bits, node, std::vector<bool>(node.children, true));
    bits.flush();
  }
  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    BitReader in(part);
    get_with_intersection(in, node, std::vector<bool>(node.children, true));
    in.finish();
  }
};

class SomeIntersected : public NodeCoder {
 public:
  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    BitWriter bits(out);
    const std::vector<bool> chosen = best_subset(node);
    for (const bool c : chosen) bits.put(c, 1);
    if (std::find(chosen.begin(), chosen.end(), true) == chosen.end()) {
      put_bits(bits, node.bits);
    } else {
      put_with_intersection(bits, node, chosen);
    }
    bits.flush();
  }
  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    BitReader in(part);
    std::vector<bool> chosen(node.children);
    for (std::uint32_t i = 0; i < node.children; ++i) chosen[i] = in.get(1) != 0;
    if (std::find(chosen.begin(), chosen.end(), true) == chosen.end()) {
      get_bits(in, node.bits);
    } else {
      get_with_intersection(in, node, chosen);
    }
    in.finish();
  }

 private:
  // Saved by S against zach0: |S| ones - m.
  static std::vector<bool> best_subset(const ChildBits& node) {
    const std::uint32_t k = node.children;
    std::vector<bool> best(k, false);
    std::uint64_t best_saving = 0;
    const auto try_subset = [&](std::uint64_t size, std::uint64_t ones, const auto& is_chosen) {
      if (size * ones <= node.members + best_saving) return;
      best_saving = size * ones - node.members;
      for (std::uint32_t i = 0; i < k; ++i) best[i] = is_chosen(i);
    };
    if (k <= 10) {
      std::vector<std::uint64_t> cells_of_pattern(std::size_t{1} << k,
                                                  0);  // by the set of children seen there
      for (std::uint32_t p = 0; p < node.members; ++p) {
        std::size_t pattern = 0;
        for (std::uint32_t i = 0; i < k; ++i)
          pattern |= std::size_t{node.bits[std::size_t{i} * node.members + p]} << i;
        ++cells_of_pattern[pattern];
      }
      for (std::size_t bit = 1; bit < cells_of_pattern.size(); bit *= 2) {  // sums over supersets
        for (std::size_t s = 0; s < cells_of_pattern.size(); ++s) {
          if ((s & bit) == 0) cells_of_pattern[s] += cells_of_pattern[s | bit];
        }
      }
      for (std::size_t s = 1; s < cells_of_pattern.size(); ++s) {
        try_subset(static_cast<std::uint64_t>(std::popcount(s)), cells_of_pattern[s],
                   [s](std::uint32_t i) { return (s >> i & 1) != 0; });
      }
      return best;
    }
    std::vector<std::pair<std::int64_t, std::uint32_t>> densest;  // (-ones, child)
    for (std::uint32_t i = 0; i < k; ++i) {
      const auto* bits = node.bits.data() + std::size_t{i} * node.members;
      densest.emplace_back(-std::count(bits, bits + node.members, std::uint8_t{1}), i);
    }
    std::sort(densest.begin(), densest.end());
    std::vector<std::uint8_t> common(node.members, 1);
    std::vector<bool> chosen(k, false);
    for (std::uint32_t size = 1; size <= k; ++size) {
      const std::uint32_t child = densest[size - 1].second;
      chosen[child] = true;
      std::uint64_t ones = 0;
      for (std::uint32_t p = 0; p < node.members; ++p) {
        common[p] &= node.bits[std::size_t{child} * node.members + p];
        ones += common[p];
      }
      try_subset(size, ones, [&](std::uint32_t i) { return chosen[i]; });
    }
    return best;
  }
};

// --- zach3, zach4: lengths
// ----------------------------------------------------------------------------------

// The first place from `i` on that does not hold `value`, or the end. Runs are short: a call of memchr for each costs more.
std::size_t end_of_run(std::span<const std::uint8_t> bits, std::size_t i, std::uint8_t value) {
  for (; i + 8 <= bits.size(); i += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, bits.data() + i, 8);
    eight ^= value * 0x0101010101010101u;
    if (eight != 0) return i + static_cast<std::size_t>(std::countr_zero(eight)) / 8;
  }
  while (i < bits.size() && bits[i] == value) ++i;
  return i;
}

// One of the two divisions of a row of bits into lengths: cut(bits, emit) calls emit(context, length >= 1), and paste, asking
// next(context) for lengths, undoes it. `contexts` says how many tables a coder with contexts may keep.
struct AlternatingRuns {
  static constexpr std::size_t contexts = 2;  // the run's value
  static constexpr unsigned first_bits = 1;   // for the first run's value

  template <typename Emit>
  static void cut(std::span<const std::uint8_t> bits, const Emit& emit) {
    for (std::size_t i = 0; i < bits.size();) {
      const std::size_t end = end_of_run(bits, i, bits[i]);
      emit(bits[i], static_cast<std::uint32_t>(end - i));
      i = end;
    }
  }
  template <typename Next>
  static void paste(std::span<std::uint8_t> bits, std::uint8_t first, const Next& next) {
    for (std::size_t i = 0; i < bits.size(); first = 1 - first) {
      const std::size_t length = next(first);
      if (length > bits.size() - i)
        throw FormatError("a run of " + std::to_string(length) + " ends after the last bit");
      std::memset(bits.data() + i, first, length);
      i += length;
    }
  }
};

struct OnesBeforeZeros {
  static constexpr std::size_t contexts = 1;
  static constexpr unsigned first_bits = 0;

  template <typename Emit>
  static void cut(std::span<const std::uint8_t> bits,
                  const Emit& emit) {  // as if a zero followed the last bit
    for (std::size_t i = 0; i <= bits.size();) {
      const std::size_t end = end_of_run(bits, i, 1);
      emit(std::size_t{0}, static_cast<std::uint32_t>(end - i + 1));
      i = end + 1;
    }
  }
  template <typename Next>
  static void paste(std::span<std::uint8_t> bits, std::uint8_t, const Next& next) {
    for (std::size_t i = 0; i <= bits.size();) {
      const std::size_t ones = next(std::size_t{0}) - 1;
      if (ones > bits.size() - i) throw FormatError(std::to_string(ones) + " ones end after the last bit");
      std::memset(bits.data() + i, 1, ones);
      i += ones;
      if (i < bits.size()) bits[i] = 0;
      ++i;
    }
  }
};

// What both entropy coders do first: they count symbols, by context.
template <typename Lengths>
class CountedLengths : public NodeCoder {
 public:
  bool learns() const override { return true; }
  void see(const ChildBits& node) override {
    bits_ += node.bits.size();
    Lengths::cut(node.bits, [this](std::size_t context, std::uint32_t length) {
      ++frequencies_[context][symbol_of_length(length).symbol];
    });
  }
  LengthStatistics statistics() const override {
    std::array<std::uint64_t, LengthSymbol::count> together = {};
    for (const auto& of_context : frequencies_) {
      for (std::uint32_t s = 0; s < LengthSymbol::count; ++s) together[s] += of_context[s];
    }
    LengthStatistics all{bits_, std::accumulate(together.begin(), together.end(), std::uint64_t{0}), 0};
    for (std::uint32_t s = 0; s < LengthSymbol::count; ++s) {
      const auto f = static_cast<double>(together[s]);
      if (f == 0) continue;
      all.entropy_bytes += f * (std::log2(static_cast<double>(all.lengths) / f) + raw_bits_of_symbol(s)) / 8;
    }
    return all;
  }

 protected:
  std::uint64_t bits_ = 0;
  std::array<std::array<std::uint64_t, LengthSymbol::count>, Lengths::contexts> frequencies_ = {};
};

template <typename Lengths>
class HuffmanLengths : public CountedLengths<Lengths> {
 public:
  void write_model(std::vector<std::byte>& out) override {
    for (std::size_t c = 0; c < Lengths::contexts; ++c) {
      codes_[c] = HuffmanCode::from_frequencies(this->frequencies_[c]);
      codes_[c].write(out);
    }
  }
  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    if (node.bits.empty()) return;
    BitWriter bits(out);
    if (Lengths::first_bits == 1) bits.put(node.bits[0], 1);
    Lengths::cut(node.bits, [&](std::size_t context, std::uint32_t length) {
      const LengthSymbol s = symbol_of_length(length);
      codes_[context].put(bits, s.symbol);
      bits.put(s.raw, s.raw_count);
    });
    bits.flush();
  }
  void read_model(ByteReader& in) override {
    for (HuffmanCode& code : codes_) code = HuffmanCode::read(in, LengthSymbol::count);
  }
  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    BitReader in(part);
    if (!node.bits.empty()) {
      const auto first = static_cast<std::uint8_t>(in.get(Lengths::first_bits));
      Lengths::paste(node.bits, first, [&](std::size_t context) {
        const std::uint32_t symbol = codes_[context].get(in);
        const std::uint32_t length = length_of_symbol(symbol, in.get(raw_bits_of_symbol(symbol)));
        if (in.overran()) throw FormatError("the bits end before the last run");
        return length;
      });
    }
    in.finish();
  }

 private:
  std::array<HuffmanCode, Lengths::contexts> codes_;
};

template <typename Lengths>
class RangeLengths : public CountedLengths<Lengths> {
 public:
  void write_model(std::vector<std::byte>& out) override {
    for (std::size_t c = 0; c < Lengths::contexts; ++c) {
      tables_[c] = FrequencyTable::from_frequencies(this->frequencies_[c]);
      tables_[c].write(out);
    }
  }
  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    if (node.bits.empty()) return;
    RangeEncoder coder(out);
    if (Lengths::first_bits == 1) coder.put_raw(node.bits[0], 1);
    Lengths::cut(node.bits, [&](std::size_t context, std::uint32_t length) {
      const LengthSymbol s = symbol_of_length(length);
      coder.put(tables_[context], s.symbol);
      coder.put_raw(s.raw, s.raw_count);
    });
    coder.finish();
  }
  void read_model(ByteReader& in) override {
    for (FrequencyTable& table : tables_) table = FrequencyTable::read(in, LengthSymbol::count);
  }
  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    if (node.bits.empty()) {
      if (!part.empty()) throw FormatError("bytes for a node that no cell sees");
      return;
    }
    RangeDecoder in(part);
    const auto first = static_cast<std::uint8_t>(in.get_raw(Lengths::first_bits));
    Lengths::paste(node.bits, first, [&](std::size_t context) {
      const std::uint32_t symbol = in.get(tables_[context]);
      return length_of_symbol(symbol, in.get_raw(raw_bits_of_symbol(symbol)));
    });
  }

 private:
  std::array<FrequencyTable, Lengths::contexts> tables_;
};

template <typename Coder>
constexpr Codec method(std::string_view name, std::string_view contents, bool row_order = false) {
  Codec codec = tree_codec<Coder, TreeOver::columns>(name, contents, Origin::paper);
  codec.needs.row_order = row_order;
  return codec;
}

constexpr std::array zach_table = {
    method<PlainBits>("zach0", "children's bits in the parent's cells"),
    method<AllIntersected>("zach1", "intersection of all children, bits outside it"),
    method<SomeIntersected>("zach2", "intersection of a chosen subset, subset masks, bits outside it"),
    method<HuffmanLengths<AlternatingRuns>>(
        "zach3-huffman", "run lengths, a Huffman code each for runs of zeros and of ones", true),
    method<RangeLengths<AlternatingRuns>>(
        "zach3-range", "run lengths, range coded, frequencies each for runs of zeros and of ones", true),
    method<HuffmanLengths<OnesBeforeZeros>>("zach4-huffman", "ones before each zero, one Huffman code", true),
    method<RangeLengths<OnesBeforeZeros>>("zach4-range", "ones before each zero, range coded", true),
};

}  // namespace

std::span<const Codec> zach_codecs() {
  return zach_table;
}

}  // namespace vismat
