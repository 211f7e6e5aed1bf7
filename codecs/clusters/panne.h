// The codec `panne`: van de Panne and Stewart's lossless compression of a visibility matrix [van de Panne, Stewart
// 1999]. Subsets that several rows or columns have in common become clusters; the rest of the matrix, which is now
// sparser, is coded by its runs of zeros. panne_table.h says what a cluster is and what a list costs, panne_search.h
// how clusters are found, docs/vmat.md gives the bytes.
//
//   model   the clusters' lists, and a Huffman code for each kind of number
//   row     its list; a row that would take as many bytes as its bitmap is stored as its bitmap
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "codecs/clusters/panne_search.h"
#include "codecs/entropy/huffman.h"
#include "codecs/rows/row_codec.h"

namespace vismat {

/// Encodes as the codec `panne` does, with a table that was searched before.
Encoded encode_panne(const VisibilityMatrix& matrix, const PanneTable& table);

/// A Huffman code for numbers of one kind, or for the numbers of all kinds of steps.
class PanneCode {
 public:
  static constexpr std::uint32_t object = 0, run = 1, cluster = 2,
                                 end = 3;  // kinds of steps, as PanneNumber has them
  static constexpr std::uint32_t steps = 3 * LengthSymbol::count + 1;  // symbols: an end has no length

  explicit PanneCode(std::uint32_t symbols = LengthSymbol::count) : counts_(symbols, 0) {}
  void count(std::uint32_t number, std::uint32_t kind = 0) {
    ++counts_[kind * LengthSymbol::count + symbol_of_length(number).symbol];
  }
  void write(std::vector<std::byte>& out) {
    code_ = HuffmanCode::from_frequencies(counts_);
    code_.write(out);
  }
  void read(ByteReader& in) { code_ = HuffmanCode::read(in, static_cast<std::uint32_t>(counts_.size())); }
  void put(BitWriter& out, std::uint32_t number, std::uint32_t kind = 0) const {
    const LengthSymbol s = symbol_of_length(number);
    code_.put(out, kind * LengthSymbol::count + s.symbol);
    out.put(s.raw, s.raw_count);
  }
  std::pair<std::uint32_t, std::uint32_t> get(BitReader& in) const {
    std::uint32_t symbol = code_.get(in);
    const std::uint32_t kind = symbol / LengthSymbol::count;
    symbol %= LengthSymbol::count;
    if (symbol < 64) [[likely]]
      return {symbol + 1, kind};
    return {length_of_symbol(symbol, in.get(raw_bits_of_symbol(symbol))), kind};
  }

 private:
  std::vector<std::uint64_t> counts_;
  HuffmanCode code_;
};

/// The row codec (row_codec.h). Decoding a row takes O(its members, and the clusters and runs that these hold) <= O(its
/// ones), and looks at each word of its bitmap. The scratch has a bit for each column.
class PanneRows {
 public:
  static constexpr std::uint32_t rows_per_part = 1;
  /// Of the options it uses the search's seconds, threads and seed.
  static PanneRows fit(const VisibilityMatrix& matrix, const Side&, const EncodeOptions& options) {
    return PanneRows(search_clusters(matrix, {.seconds = options.seconds,
                                              .seed = options.seed,
                                              .threads = options.threads,
                                              .progress = options.progress}));
  }
  explicit PanneRows(PanneTable table);
  void write_model(std::vector<std::byte>& out);
  static PanneRows read_model(ByteReader& in, Shape shape);
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t first, std::uint32_t end,
                   std::vector<std::byte>& out) const;
  template <typename Sink>
  void decode(std::span<const std::byte> part, std::uint32_t, RowScratch& scratch, Sink& sink) const {
    if (part.size() == row_bytes_of(columns_)) return get_bitmap_row(part, sink);
    if (part.empty()) return;
    if (!clusters_.empty()) {
      const SetBits bits(*this, part, scratch.as<Scratch>());
      return get_bitmap_row(bits.row(), sink);
    }
    for_each_step(part, [&](std::uint32_t zeros, std::uint32_t count, bool is_cluster) {
      if (is_cluster) throw FormatError("a cluster where there are none");
      sink.run(zeros, count);
    });
  }

 private:
  struct Cluster {
    std::uint32_t first, reach, objects;
    std::uint32_t runs, clusters;  // where its own begin in runs_ and inner_
  };
  struct Scratch {
    std::vector<std::uint64_t> words;  // all zero between rows
    std::vector<std::uint32_t> open;   // clusters to come
  };
  // The bits of a row. The destructor sets them all to zero again.
  class SetBits {
   public:
    SetBits(const PanneRows& rows, std::span<const std::byte> part, Scratch& scratch);
    ~SetBits() { clear(); }
    SetBits(const SetBits&) = delete;
    SetBits& operator=(const SetBits&) = delete;
    std::span<const std::byte> row() const { return row_; }

   private:
    void clear() const;
    std::span<std::byte> row_;
  };
  PanneRows() = default;
  // Calls step(zeros, count, is_cluster) for each step of a row: `count` objects, or the cluster of rank `count`.
  template <typename Step>
  void for_each_step(std::span<const std::byte> part, const Step& step) const {
    BitReader in(part);
    auto [number, kind] = steps_.get(in);
    if (kind == PanneCode::end) throw FormatError("bits, but no step");
    while (kind != PanneCode::end) {
      if (in.overran()) [[unlikely]]
        throw FormatError("the row ends early");
      const std::uint32_t zeros = number - 1;
      std::uint32_t count = 1;
      if (kind != PanneCode::object)
        count = kind == PanneCode::cluster ? ranks_.get(in).first : run_of_objects(in);
      step(zeros, count, kind == PanneCode::cluster);
      std::tie(number, kind) = steps_.get(in);
    }
    in.finish();
  }
  std::uint32_t run_of_objects(BitReader& in) const {
    const std::uint32_t number = run_lengths_.get(in).first;
    if (number == 0xffffffff) [[unlikely]]
      throw FormatError("a run of too many objects");
    return number + 1;
  }
  void read_clusters(ByteReader& in, std::uint32_t count);
  void set_row(std::span<const std::byte> part, std::uint64_t* words, std::vector<std::uint32_t>& open) const;
  void set_cluster(std::uint32_t cluster, std::uint64_t* words, std::vector<std::uint32_t>& open) const;
  std::uint32_t cluster_at(std::uint32_t first, std::uint32_t rank) const;
  void put_list(BitWriter& out, std::uint32_t list) const;
  template <typename Visit>
  void for_each_number(std::uint32_t list, const Visit& visit) const;

  std::uint32_t columns_ = 0;
  PanneCode steps_{PanneCode::steps}, run_lengths_, ranks_, leads_, heads_;

  std::vector<Cluster> clusters_;  // by (first, rank), one more behind the last; none where there are none
  std::vector<std::uint32_t> begin_at_;  // of those that begin at a column, one more behind the last
  std::vector<Run> runs_;                // of a cluster's own objects
  std::vector<std::uint32_t> inner_;     // clusters that a cluster holds

  std::optional<PanneTable> table_;      // of an encoder
  std::vector<std::uint32_t> in_order_;  // their members, by (first, rank)
};

}  // namespace vismat
