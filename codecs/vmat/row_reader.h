// Reads rows of a `.vmat` file, one at a time: the header for engines. It needs only POSIX (the file is mapped) and the
// C++20 standard library.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "codecs/codec.h"
#include "codecs/vmat/row_sink.h"
#include "codecs/vmat/row_source.h"

namespace vismat {

/// Reads a row of an open file without reading other rows, except those that it is coded against. The file is mapped,
/// each block of 4096 bytes is checked by its checksum when it is first needed, and a row costs what its own bytes
/// cost. Opening reads the head, 4 bytes for each block, and the tree if the codec has one.
///
/// Any number of threads may read from one reader at a time, each with a buffer of its own. All other memory that
/// decoding takes is in that buffer, and nothing is allocated except when it grows. Only the codec `roaring` allocates,
/// in its own library.
///
/// Every function throws FormatError, which names the file, if the bytes that it needs are damaged. The file must not
/// be truncated while it is open: the system would then end the program (SIGBUS), as with any mapped file.
class RowReader {
 public:
  /// Reads files of those of `codecs` that decode single rows; the table is not needed afterwards. `boxes` are those of
  /// the rows and columns, for codecs that need them; borrowed. Throws FormatError if it is not a whole `.vmat` file of
  /// such a codec, or was coded with other boxes; std::runtime_error if the file cannot be opened.
  explicit RowReader(const std::filesystem::path& file, std::span<const Codec> codecs = own_codecs(),
                     const Side& boxes = {});
  /// Reads the bytes of a file; they must outlive the reader.
  explicit RowReader(std::span<const std::byte> bytes, std::span<const Codec> codecs = own_codecs(),
                     const Side& boxes = {});
  ~RowReader();
  RowReader(RowReader&&) noexcept;
  RowReader& operator=(RowReader&&) noexcept;

  Shape shape() const;
  std::uint64_t ones() const;
  std::string_view codec() const;
  std::string facts() const;

  /// Row `row` < shape().rows as it is in the file: ascending columns; runs of columns; or bits, column c as bit c % 64
  /// of word c / 64, all (columns + 63) / 64 words written. What ids and runs return lies in `buffer`; `scratch` may be
  /// any buffer. Throws std::out_of_range for a row that does not exist, std::length_error for too few words.
  std::span<const std::uint32_t> ids(std::uint32_t row, RowBuffer<std::uint32_t>& buffer) const;
  std::span<const Run> runs(std::uint32_t row, RowBuffer<Run>& buffer) const;
  void bits(std::uint32_t row, std::span<std::uint64_t> words, RowScratch& scratch) const;
  /// What reading this row alone reads of the payload. Rows that share their bytes cost all of these.
  RowSource::Cost cost(std::uint32_t row) const;

  /// How the rows and columns relate to the source's: orders, groups, trees, boundaries, names. Read again at each
  /// call.
  SourceMap source() const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace vismat
