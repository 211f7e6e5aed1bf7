// The row codec `bv`: rows as successor lists of a web graph [Boldi, Vigna 2004, "The WebGraph framework I: compression
// techniques", sections 4 and 5]. A row names one of the 7 rows before it, tells which of that row's columns it also has
// (copy blocks), and lists the others as intervals and residuals. bv.cpp says what WebGraph itself does differently.
//
// With x the row's number, g(n) Elias' gamma code of n + 1 and z(n) the zeta code of n + 1 with k = 3, a row of d >= 1
// ids is, lowest bit first and with zeros up to a byte:
//
//   g(d)               a row without ids has no bytes
//   r zeros and a 1    its reference is row x - r; r <= 7, and 0: none
//   with a reference   g(b), and b copy blocks: the reference's ids are cut into blocks that are copied and skipped in turn.
//                      The first is g(length) and copied, the others are g(length - 1); what is left is one more block
//   if ids are missing g(i), and i intervals of at least 4 ids that follow one another: their first id, told as s(first - x) for
//                      the first interval and g(first - end of the one before - 1) for others, and g(length - 4)
//                      the residuals: z(s(id - x)) for the first, z(id - the one before - 1) for others
//
// where s(n) is 2 n, or 2 |n| - 1 if n < 0. A row that would take as many bytes as its bitmap is its bitmap.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/bit_stream.h"
#include "codecs/rows/row_codec.h"

namespace vismat {

/// A row codec (row_codec.h).
class BvRows {
 public:
  /// WebGraph's defaults: rows looked back at, references in a row, ids of an interval, and zeta's k.
  static constexpr std::uint32_t window = 7, longest_chain = 3, least_interval = 4, zeta = 3;
  static constexpr std::uint32_t rows_per_part = 1;

  static BvRows fit(const VisibilityMatrix&) { return {}; }
  void write_model(std::vector<std::byte>&) const {}
  static BvRows read_model(ByteReader&, Shape shape) {
    BvRows rows;
    rows.columns_ = shape.columns;
    return rows;
  }
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t row, std::uint32_t end,
                   std::vector<std::byte>& out);

  /// A row against a reference (empty: none, and then r is 0) as the numbers that are coded, and their bits.
  struct Plan {
    std::vector<std::uint32_t> blocks, residuals;
    std::vector<Run> intervals;
    std::uint64_t bits = 0;
    void make(std::span<const std::uint32_t> ids, std::span<const std::uint32_t> reference, std::uint32_t row,
              std::uint32_t r);
  };

  template <typename Sink>
  void decode_row(std::uint32_t row, const Parts& parts, RowScratch& scratch, Sink& sink) const {
    for (const Run run : runs_of(row, parts, scratch.as<Scratch>()))
      sink.run(run.first - sink.next(), run.count);
  }
  RowSource::Cost cost(std::uint32_t row, const Parts& parts) const;

 private:
  // Rows as runs: what they take is bounded by their bits, whatever they claim.
  struct Scratch {
    std::vector<Run> reference, row, copied, intervals;
  };
  std::span<const Run> runs_of(std::uint32_t row, const Parts& parts, Scratch& scratch) const;
  std::uint32_t reference_of(std::uint32_t row, std::span<const std::byte> part) const;

  std::uint32_t columns_ = 0;
  std::vector<std::uint8_t> chain_;  // an encoder's: how many references lead on from each row
  Plan plan_, best_;
};

}  // namespace vismat
