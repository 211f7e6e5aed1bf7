// Rows of a `.vmat` file, one at a time: what an engine links. Standard library alone.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codecs/codec.h"
#include "codecs/row_sink.h"
#include "matrix/deltas.h"
#include "matrix/partition.h"
#include "matrix/permutation.h"

namespace vismat {

/// Reads a row of an open file without touching others: the file is mapped, each 4096-byte block of it is checked by its
/// checksum when it is first needed, and a row costs what its own bytes cost. Opening reads the head and 4 bytes a block.
/// Any number of threads may read from one reader at a time, each with a buffer of its own; nothing is allocated for a row
/// but when that buffer grows.
///
/// Every function throws FormatError, naming the file, where the bytes that it needs are damaged. The file must not be cut
/// short while it is open: the system then ends the program (SIGBUS), as with any mapped file.
class RowReader {
 public:
  /// Throws FormatError where it is no whole `.vmat` file of a codec of `codecs` that gives rows alone; std::runtime_error
  /// where it cannot be opened.
  explicit RowReader(const std::filesystem::path& file, std::span<const Codec> codecs = own_codecs());
  /// The bytes of a file; they must outlive the reader.
  explicit RowReader(std::span<const std::byte> bytes, std::span<const Codec> codecs = own_codecs());
  ~RowReader();
  RowReader(RowReader&&) noexcept;
  RowReader& operator=(RowReader&&) noexcept;

  Shape shape() const;
  std::uint64_t ones() const;
  std::string_view codec() const;
  std::string facts() const;

  /// Row `row` < shape().rows as the file has it: ascending columns; runs of columns; bits, column c as bit c % 64 of word
  /// c / 64, all (columns + 63) / 64 words written. What ids and runs return lies in `buffer`. Throws std::out_of_range for
  /// a row that is none, std::length_error for too few words.
  std::span<const std::uint32_t> ids(std::uint32_t row, RowBuffer<std::uint32_t>& buffer) const;
  std::span<const Run> runs(std::uint32_t row, RowBuffer<Run>& buffer) const;
  void bits(std::uint32_t row, std::span<std::uint64_t> words) const;
  /// Bytes of the payload that the row takes; where rows share their bytes, all of these.
  std::uint64_t row_bytes(std::uint32_t row) const;

  /// Where the source's rows and columns stand in the file; nullopt where they were not reordered. Read anew at each call.
  std::optional<Permutation> row_order() const;
  std::optional<Permutation> column_order() const;
  /// Which row or column of the file stands for each of the source's; nullopt where none were merged. Read anew at each call.
  std::optional<Partition> row_groups() const;
  std::optional<Partition> column_groups() const;
  /// Between which view cells the rows are differences (Deltas in matrix/deltas.h); empty where rows are view cells.
  std::vector<Boundary> boundaries() const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace vismat
