// Codecs that use what the interface has room for and no codec of the table needs yet: rows that depend on rows, shared sections,
// bands, boxes. docs/adding_a_codec.md goes through the first.
#pragma once
#include <algorithm>
#include <iterator>
#include <span>
#include <vector>

#include "codecs/integer_codes/universal_codes.h"
#include "codecs/rows/pairs.h"
#include "codecs/rows/row_codec.h"

namespace vismat::test {

using Ids = std::vector<std::uint32_t>;

inline void put_ids(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) {
  PairRows<GammaCode>().encode(ids, out);
}
inline std::span<const std::uint32_t> get_ids(std::span<const std::byte> bytes, std::uint32_t columns,
                                              RowBuffer<std::uint32_t>& buffer) {
  IdSink sink(buffer, columns, columns);
  PairRows<GammaCode>().decode(bytes, sink);
  sink.finish();
  return buffer.content();
}
inline void exclusive_or(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b, Ids& out) {
  out.clear();
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
}
template <typename Sink>
void put_runs(std::span<const std::uint32_t> ids, Sink& sink) {
  for_each_run(ids, [&](std::uint32_t first, std::uint32_t count) { sink.run(first - sink.next(), count); });
}

/// A row is its differences to the row before; the first of each band of 8 rows, to the columns that most rows see, which are the
/// shared section 0.
class RowDifferences {
 public:
  static constexpr std::uint32_t rows_per_part = 1, rows_per_band = 8;
  static RowDifferences fit(const VisibilityMatrix& matrix, const Side&, const EncodeOptions&) {
    RowDifferences rows;
    rows.shape_ = matrix.shape();
    Ids count(rows.shape_.columns, 0);
    for (std::uint32_t r = 0; r < rows.shape_.rows; ++r) {
      for (const std::uint32_t c : matrix.row(r)) ++count[c];
    }
    for (std::uint32_t c = 0; c < count.size(); ++c) {
      if (2 * count[c] > rows.shape_.rows) rows.common_.push_back(c);
    }
    return rows;
  }
  void write_model(std::vector<std::byte>&) const {}
  static RowDifferences read_model(ByteReader&, Shape shape) {
    RowDifferences rows;
    rows.shape_ = shape;
    return rows;
  }
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t row, std::uint32_t,
                   std::vector<std::byte>& out) const {
    Ids changes;
    exclusive_or(matrix.row(row),
                 row % rows_per_band == 0 ? std::span<const std::uint32_t>(common_) : matrix.row(row - 1),
                 changes);
    put_ids(changes, out);
  }
  void write_shared(Encoded& out) const {
    for (std::uint32_t r = 0; r < shape_.rows; r += rows_per_band) out.bands.push_back(r);
    if (!common_.empty()) put_ids(common_, out.shared.emplace_back());
  }

  struct Scratch {
    RowBuffer<std::uint32_t> changes;
    Ids row, next;
  };
  template <typename Sink>
  void decode_row(std::uint32_t row, const Parts& parts, RowScratch& kept, Sink& sink) const {
    auto& [changes, ids, next] = kept.as<Scratch>();
    ids.clear();
    if (parts.shared_count() > 0) {
      const auto common = get_ids(parts.shared(0), shape_.columns, changes);
      ids.assign(common.begin(), common.end());
    }
    for (std::uint32_t r = begin_of_band(row, parts); r <= row; ++r) {
      exclusive_or(ids, get_ids(parts.part(r), shape_.columns, changes), next);
      ids.swap(next);
    }
    put_runs(ids, sink);
  }
  RowSource::Cost cost(std::uint32_t row, const Parts& parts) const {
    RowSource::Cost cost;
    for (std::uint32_t r = begin_of_band(row, parts); r <= row; ++r, ++cost.parts)
      cost.bytes += parts.part_bytes(r);
    return cost;
  }

 private:
  static std::uint32_t begin_of_band(std::uint32_t row, const Parts& parts) {
    if (parts.bands().empty()) throw FormatError("no bands of rows");
    return *(std::upper_bound(parts.bands().begin(), parts.bands().end(), row) - 1);
  }
  Shape shape_;
  Ids common_;  // an encoder's
};

/// A row is its differences to the columns whose boxes touch the row's own: no byte of a matrix that boxes tell wholly.
class RowsUnderBoxes {
 public:
  static constexpr std::uint32_t rows_per_part = 1;
  static RowsUnderBoxes fit(const VisibilityMatrix&, const Side& side, const EncodeOptions&) {
    return RowsUnderBoxes(side);
  }
  void write_model(std::vector<std::byte>&) const {}
  static RowsUnderBoxes read_model(ByteReader&, Shape, const Side& side) { return RowsUnderBoxes(side); }
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t row, std::uint32_t,
                   std::vector<std::byte>& out) const {
    Ids near, changes;
    touching(row, near);
    exclusive_or(matrix.row(row), near, changes);
    put_ids(changes, out);
  }
  struct Scratch {
    RowBuffer<std::uint32_t> changes;
    Ids near, ids;
  };
  template <typename Sink>
  void decode_row(std::uint32_t row, const Parts& parts, RowScratch& kept, Sink& sink) const {
    auto& [changes, near, ids] = kept.as<Scratch>();
    touching(row, near);
    exclusive_or(near, get_ids(parts.part(row), sink.columns(), changes), ids);
    put_runs(ids, sink);
  }
  RowSource::Cost cost(std::uint32_t row, const Parts& parts) const { return {parts.part_bytes(row), 1}; }

 private:
  explicit RowsUnderBoxes(const Side& side) : side_(side) {}
  void touching(std::uint32_t row, Ids& ids) const {
    ids.clear();
    const Box& a = side_.row_boxes[row];
    for (std::uint32_t c = 0; c < side_.column_boxes.size(); ++c) {
      const Box& b = side_.column_boxes[c];
      bool touch = true;
      for (std::size_t i = 0; i < 3; ++i) touch = touch && a.low[i] <= b.high[i] && b.low[i] <= a.high[i];
      if (touch) ids.push_back(c);
    }
  }
  Side side_;
};

inline const Codec& row_differences() {
  static const Codec codec =
      row_codec<RowDifferences>("toy-differences", "differences to the row before", Origin::ours);
  return codec;
}
inline const Codec& rows_under_boxes() {
  static const Codec codec = [] {
    Codec under = row_codec<RowsUnderBoxes>("toy-boxes", "differences to what boxes tell", Origin::ours);
    under.needs.boxes = true;
    return under;
  }();
  return codec;
}

}  // namespace vismat::test
