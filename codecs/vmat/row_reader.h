// Rows of a `.vmat` file, one at a time: what an engine links. POSIX (the file is mapped) and the C++20 standard library alone.
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

/// Reads a row of an open file without touching others but those that it is coded against: the file is mapped, each 4096-byte
/// block of it is checked by its checksum when it is first needed, and a row costs what its own bytes cost. Opening reads the
/// head, 4 bytes a block, and of a codec over a tree the tree.
/// Any number of threads may read from one reader at a time, each with a buffer of its own. All that decoding takes besides lies
/// in that buffer, and nothing is allocated but when it grows; codec `roaring` alone allocates, in its own library.
///
/// Every function throws FormatError, naming the file, where the bytes that it needs are damaged. The file must not be cut
/// short while it is open: the system then ends the program (SIGBUS), as with any mapped file.
class RowReader {
 public:
  /// Reads files of those `codecs` that give rows alone; the table is not needed afterwards. `boxes`: of the rows and columns,
  /// for codecs that code under them; borrowed. Throws FormatError where it is no whole `.vmat` file of such a codec, or was
  /// coded under other boxes; std::runtime_error where it cannot be opened.
  explicit RowReader(const std::filesystem::path& file, std::span<const Codec> codecs = own_codecs(),
                     const Side& boxes = {});
  /// The bytes of a file; they must outlive the reader.
  explicit RowReader(std::span<const std::byte> bytes, std::span<const Codec> codecs = own_codecs(),
                     const Side& boxes = {});
  ~RowReader();
  RowReader(RowReader&&) noexcept;
  RowReader& operator=(RowReader&&) noexcept;

  Shape shape() const;
  std::uint64_t ones() const;
  std::string_view codec() const;
  std::string facts() const;

  /// Row `row` < shape().rows as the file has it: ascending columns; runs of columns; bits, column c as bit c % 64 of word
  /// c / 64, all (columns + 63) / 64 words written. What ids and runs return lies in `buffer`; `scratch` may be any buffer.
  /// Throws std::out_of_range for a row that is none, std::length_error for too few words.
  std::span<const std::uint32_t> ids(std::uint32_t row, RowBuffer<std::uint32_t>& buffer) const;
  std::span<const Run> runs(std::uint32_t row, RowBuffer<Run>& buffer) const;
  void bits(std::uint32_t row, std::span<std::uint64_t> words, RowScratch& scratch) const;
  /// What the row, read alone, takes of the payload; where rows share their bytes, all of these.
  RowSource::Cost cost(std::uint32_t row) const;

  /// How the rows and columns relate to the source's: orders, groups, trees, boundaries, names. Read anew at each call.
  SourceMap source() const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace vismat
