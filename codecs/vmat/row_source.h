// Reads the rows of one payload, one at a time. A row codec opens one, and readers of whole matrices loop over it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "codecs/codec.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/row_sink.h"
#include "matrix/claimed_shape.h"

namespace vismat {

/// Holds what all rows share and where the rest begins. It never changes, so any number of threads may read at a time,
/// each with a scratch of its own. The scratch keeps what else a row needs: the rows it is coded against, or the sets
/// on the path through a tree. Nothing is allocated once the scratch has held what the longest row takes.
class RowSource {
 public:
  virtual ~RowSource() = default;
  /// Row `row` < the shape's rows. Throws FormatError on bytes that no encoder made.
  virtual void read(std::uint32_t row, RowScratch&, IdSink&) const = 0;
  virtual void read(std::uint32_t row, RowScratch&, RunSink&) const = 0;
  virtual void read(std::uint32_t row, RowScratch&, BitSink&) const = 0;
  /// Whether every word of a BitSink is written, so that they need not be zero before.
  virtual bool writes_all_words() const { return false; }
  /// What reading a row alone reads of the payload. Rows that share their bytes cost all of these.
  struct Cost {
    std::uint64_t bytes = 0, parts = 0;
  };
  virtual Cost cost(std::uint32_t row) const = 0;
};

/// The matrix whose rows read(row, scratch, sink) gives, one after another, from a payload of `bytes` bytes. Throws
/// FormatError at more than `most` ones. The bytes back what is allocated at once; the rest is allocated as rows come.
template <typename Read>
VisibilityMatrix matrix_of_rows(Shape shape, std::uint64_t bytes, std::uint64_t most, const Read& read) {
  if (bytes == 0) claimed_shape(shape.rows, 0, 0);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::min<std::uint64_t>(shape.rows, (1 << 22) + 8 * bytes) + 1);
  std::vector<std::uint32_t> ids;
  RowBuffer<std::uint32_t> row;
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    IdSink sink(row, shape.columns, most - ids.size());
    read(r, row, sink);
    sink.finish();
    ids.insert(ids.end(), row.content().begin(), row.content().end());
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

/// All rows in turn. Throws FormatError at more than `most` ones. Memory grows with what is decoded.
VisibilityMatrix read_all_rows(const RowSource& rows, const Parts& parts, Shape shape, std::uint64_t most);

}  // namespace vismat
