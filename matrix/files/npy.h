// Reads and writes NumPy's .npy, one array in a file (numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#pragma once
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// An array of a .npy file. Its items are borrowed from the file's bytes, which hold all of them.
class NpyArray {
 public:
  /// Throws FormatError for a header that NumPy would not write, for items that are neither booleans, integers, floats,
  /// complex numbers nor fixed strings, and for more or fewer bytes than the array takes.
  explicit NpyArray(std::span<const std::byte> file);

  const std::vector<std::uint64_t>& shape() const { return shape_; }
  std::uint64_t size() const { return size_; }
  bool by_columns() const { return by_columns_; }  // Fortran's order: the first index runs fastest
  bool holds_bytes() const { return kind_ == 'u' && item_ == 1; }
  bool holds_integers() const { return kind_ == 'i' || kind_ == 'u'; }
  /// Whether the item at this place of the file is anything but zero; NaN is.
  bool truth(std::uint64_t place) const;
  /// An integer that is not negative, or FormatError.
  std::uint64_t index(std::uint64_t place) const;
  std::int64_t signed_index(std::uint64_t place) const;  // an integer
  std::string text() const;  // of a single string in ASCII; empty for everything else
  std::span<const std::byte> items() const { return items_; }

 private:
  void parse_header(std::string_view header);
  void parse_type(std::string_view type);

  char kind_ = 0;  // NumPy's letter: b, i, u, f, c, S or U
  std::size_t item_ = 0;
  bool big_endian_ = false, by_columns_ = false;
  std::vector<std::uint64_t> shape_;
  std::uint64_t size_ = 1;
  std::span<const std::byte> items_;
};

bool is_npy(std::span<const std::byte> file);
/// The matrix of an array with two dimensions; what is not zero is visible. Throws FormatError.
VisibilityMatrix read_npy(std::span<const std::byte> file);
/// The same from bits as numpy.packbits(matrix, axis=1) packs them, the first into a byte's highest.
VisibilityMatrix read_packed_npy(std::span<const std::byte> file, std::uint32_t columns);

/// The bytes before the items of an array in C order.
std::string npy_header(const std::string& type, const std::vector<std::uint64_t>& shape);
/// Writes an array of booleans, a byte for each, or of bits as numpy.packbits(matrix, axis=1) packs them. The caller
/// checks the stream.
void write_npy(std::ostream& out, const VisibilityMatrix& matrix);
void write_packed_npy(std::ostream& out, const VisibilityMatrix& matrix);

}  // namespace vismat
