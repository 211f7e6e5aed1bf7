#include "matrix/files/npy.h"

#include <algorithm>
#include <charconv>
#include <ostream>
#include <string_view>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

constexpr std::string_view npy_magic = "\x93NUMPY";

[[noreturn]] void refuse_npy(const std::string& what) {
  throw FormatError(".npy: " + what);
}

// The header is the text of a Python dict with three keys, in any order.
class HeaderScanner {
 public:
  explicit HeaderScanner(std::string_view text) : rest_(text) {}

  bool take(std::string_view token) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size()));
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }
  void need(std::string_view token) {
    if (!take(token)) fail("'" + std::string(token) + "'");
  }
  std::string_view string() {
    const char quote = take("'") ? '\'' : '"';
    if (quote == '"') need("\"");
    const std::size_t end = rest_.find(quote);
    if (end == std::string_view::npos) fail("the end of a string");
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return text;
  }
  std::uint64_t number() {
    take("");
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{}) fail("a whole number of 64 bits");
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    if (rest_.starts_with('L')) rest_.remove_prefix(1);  // Python 2 wrote long numbers so
    return value;
  }
  bool at_end() { return take("\n"), take(""), rest_.empty(); }
  [[noreturn]] void fail(const std::string& wanted) const {
    refuse_npy("its header has no " + wanted + " " + std::to_string(rest_.size()) +
               " bytes before its end, where NumPy writes one");
  }

 private:
  std::string_view rest_;
};

VisibilityMatrix matrix_of(Shape shape, bool by_columns, const auto& visible) {
  const Shape lines = by_columns ? Shape{shape.columns, shape.rows} : shape;
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{lines.rows} + 1);
  std::vector<std::uint32_t> ids;
  for (std::uint32_t line = 0; line < lines.rows; ++line) {
    for (std::uint32_t id = 0; id < lines.columns; ++id) {
      if (visible(line, id)) ids.push_back(id);
    }
    offsets.push_back(ids.size());
  }
  VisibilityMatrix matrix = VisibilityMatrix::from_csr(lines, std::move(offsets), std::move(ids));
  return by_columns ? transpose(matrix) : matrix;
}

void need_matrix(const NpyArray& array) {
  if (array.shape().size() != 2) {
    refuse_npy("has " + std::to_string(array.shape().size()) +
               (array.shape().size() == 1 ? " dimension" : " dimensions") + "; a matrix has 2");
  }
}

}  // namespace

bool is_npy(std::span<const std::byte> file) {
  return std::string_view(reinterpret_cast<const char*>(file.data()), file.size()).starts_with(npy_magic);
}

NpyArray::NpyArray(std::span<const std::byte> file) {
  ByteReader in(file, ".npy");
  if (!is_npy(file)) refuse_npy("does not begin as a .npy file");
  in.skip(npy_magic.size());
  const auto major = in.number<std::uint8_t>(), minor = in.number<std::uint8_t>();
  if (major < 1 || major > 3 || minor != 0) {
    refuse_npy("is of version " + std::to_string(major) + "." + std::to_string(minor) +
               "; 1.0, 2.0 and 3.0 are read");
  }
  const std::size_t length = major == 1 ? in.number<std::uint16_t>() : in.number<std::uint32_t>();
  const auto header = in.bytes(length);
  parse_header({reinterpret_cast<const char*>(header.data()), header.size()});
  bool fits = true;
  std::uint64_t bytes = 0;
  for (const std::uint64_t n : shape_) fits &= !__builtin_mul_overflow(size_, n, &size_);
  fits &= !__builtin_mul_overflow(size_, std::uint64_t{item_}, &bytes);
  if (!fits || bytes != in.left()) {
    refuse_npy("its array takes " + (fits ? std::to_string(bytes) : "more than 2^64") + " bytes, but " +
               std::to_string(in.left()) + " follow its header");
  }
  items_ = in.bytes(in.left());
}

void NpyArray::parse_header(std::string_view header) {
  HeaderScanner in(header);
  bool has_type = false, has_order = false, has_shape = false;
  const auto once = [&](bool& has) {
    if (std::exchange(has, true)) refuse_npy("its header names a key twice");
  };
  in.need("{");
  while (!in.take("}")) {
    const std::string_view key = in.string();
    in.need(":");
    if (key == "descr") {
      once(has_type);
      if (in.take("["))
        refuse_npy("holds records of several fields; need booleans, integers, floats or complex numbers");
      parse_type(in.string());
    } else if (key == "fortran_order") {
      once(has_order);
      by_columns_ = in.take("True");
      if (!by_columns_) in.need("False");
    } else if (key == "shape") {
      once(has_shape);
      in.need("(");
      while (!in.take(")")) {
        shape_.push_back(in.number());
        if (shape_.size() > 64) refuse_npy("has more than 64 dimensions");
        if (in.take(",")) continue;
        in.need(")");
        break;
      }
    } else {
      refuse_npy("its header has a key that is not descr, fortran_order or shape");
    }
    if (in.take(",")) continue;
    in.need("}");
    break;
  }
  if (!in.at_end()) in.fail("end");
  if (!has_type || !has_order || !has_shape)
    refuse_npy("its header lacks one of descr, fortran_order and shape");
}

void NpyArray::parse_type(std::string_view type) {
  const auto unknown = [&] {
    std::string shown(type.substr(0, 24));
    for (char& c : shown) c = c >= ' ' && c <= '~' ? c : '?';
    refuse_npy("holds items of type '" + shown + "'; need booleans, integers, floats or complex numbers");
  };
  if (type.size() < 3) unknown();
  if (std::string_view("<>=|").find(type[0]) == std::string_view::npos) unknown();
  big_endian_ = type[0] == '>';
  kind_ = type[1];
  const auto [end, error] = std::from_chars(type.data() + 2, type.data() + type.size(), item_);
  if (error != std::errc{} || end != type.data() + type.size()) unknown();
  const auto is_one_of = [&](std::initializer_list<std::size_t> sizes) {
    return std::find(sizes.begin(), sizes.end(), item_) != sizes.end();
  };
  const bool known = kind_ == 'b'   ? item_ == 1
                     : kind_ == 'f' ? is_one_of({2, 4, 8})  // long doubles differ from machine to machine
                     : kind_ == 'c' ? is_one_of({8, 16})
                     : kind_ == 'S' ? item_ <= 64
                     : kind_ == 'U' ? item_ <= 64
                                    : (kind_ == 'i' || kind_ == 'u') && is_one_of({1, 2, 4, 8});
  if (!known) unknown();
  if (kind_ == 'U') item_ *= 4;
}

bool NpyArray::truth(std::uint64_t place) const {
  const auto item = items_.subspan(place * item_, item_);
  if (kind_ != 'f' && kind_ != 'c')
    return std::any_of(item.begin(), item.end(), [](std::byte b) { return b != std::byte{0}; });
  const std::size_t number = kind_ == 'c' ? item_ / 2 : item_, sign = big_endian_ ? 0 : number - 1;
  for (std::size_t i = 0; i < item_; ++i) {
    if ((item[i] & std::byte(i % number == sign ? 0x7f : 0xff)) != std::byte{0}) return true;
  }
  return false;
}

std::int64_t NpyArray::signed_index(std::uint64_t place) const {
  const auto item = items_.subspan(place * item_, item_);
  std::uint64_t value = kind_ == 'i' && (item[big_endian_ ? 0 : item_ - 1] & std::byte{0x80}) != std::byte{0}
                            ? ~std::uint64_t{0}
                            : 0;
  for (std::size_t i = 0; i < item_; ++i)
    value = value << 8 | static_cast<std::uint64_t>(item[big_endian_ ? i : item_ - 1 - i]);
  return static_cast<std::int64_t>(value);
}

std::uint64_t NpyArray::index(std::uint64_t place) const {
  const std::int64_t value = signed_index(place);
  if (kind_ == 'i' && value < 0)
    refuse_npy("item " + std::to_string(place) + " is " + std::to_string(value) +
               "; it must not be negative");
  return static_cast<std::uint64_t>(value);
}

std::string NpyArray::text() const {
  std::string text;
  if (size_ != 1 || (kind_ != 'S' && kind_ != 'U')) return text;
  const std::size_t step = kind_ == 'U' ? 4 : 1;
  for (std::size_t i = big_endian_ ? step - 1 : 0; i < item_; i += step) {
    if (items_[i] != std::byte{0}) text += static_cast<char>(items_[i]);
  }
  return text;
}

VisibilityMatrix read_npy(std::span<const std::byte> file) {
  const NpyArray array(file);
  need_matrix(array);
  const Shape shape = claimed_shape(array.shape()[0], array.shape()[1], array.size());
  const std::uint64_t line = array.by_columns() ? shape.rows : shape.columns;
  return matrix_of(shape, array.by_columns(),
                   [&](std::uint64_t l, std::uint64_t i) { return array.truth(l * line + i); });
}

VisibilityMatrix read_packed_npy(std::span<const std::byte> file, std::uint32_t columns) {
  const NpyArray array(file);
  need_matrix(array);
  const std::uint64_t rows = array.shape()[0], bytes = array.shape()[1];
  if (!array.holds_bytes()) refuse_npy("packed bits are of type uint8, as numpy.packbits makes them");
  if (bytes != (std::uint64_t{columns} + 7) / 8) {
    refuse_npy("has " + std::to_string(bytes) + " bytes in a row, not the " +
               std::to_string((std::uint64_t{columns} + 7) / 8) + " that " + std::to_string(columns) +
               " columns take, packed along the rows (axis 1)");
  }
  const Shape shape = claimed_shape(rows, columns, array.size());
  const auto byte_of = [&](std::uint64_t r, std::uint64_t b) {
    return array.items()[array.by_columns() ? b * rows + r : r * bytes + b];
  };
  for (std::uint32_t r = 0; columns % 8 != 0 && r < shape.rows; ++r) {
    if ((byte_of(r, bytes - 1) & std::byte(0xff >> columns % 8)) != std::byte{0})
      refuse_npy("row " + std::to_string(r) + " has bits behind column " + std::to_string(columns - 1));
  }
  return matrix_of(shape, false, [&](std::uint32_t r, std::uint32_t c) {
    return (byte_of(r, c / 8) & std::byte(0x80 >> c % 8)) != std::byte{0};
  });
}

std::string npy_header(const std::string& type, const std::vector<std::uint64_t>& shape) {
  std::string dict = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (";
  for (std::size_t i = 0; i < shape.size(); ++i) dict += (i == 0 ? "" : " ") + std::to_string(shape[i]) + ",";
  if (shape.size() > 1) dict.pop_back();
  dict += "), }";
  const std::size_t before = npy_magic.size() + 4;
  dict.append(63 - (before + dict.size()) % 64, ' ');  // so that the items begin at a multiple of 64
  dict += '\n';
  std::string header(npy_magic);
  header += {1, 0, static_cast<char>(dict.size() % 256), static_cast<char>(dict.size() / 256)};
  return header + dict;
}

void write_npy(std::ostream& out, const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  const std::string header = npy_header("|b1", {shape.rows, shape.columns});
  out.write(header.data(), static_cast<std::streamsize>(header.size()));
  std::string row(shape.columns, '\0');
  for (std::uint32_t r = 0; r < shape.rows && out; ++r) {
    for (const std::uint32_t c : matrix.row(r)) row[c] = 1;
    out.write(row.data(), static_cast<std::streamsize>(row.size()));
    for (const std::uint32_t c : matrix.row(r)) row[c] = 0;
  }
}

void write_packed_npy(std::ostream& out, const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  const std::uint64_t bytes = (std::uint64_t{shape.columns} + 7) / 8;
  const std::string header = npy_header("|u1", {shape.rows, bytes});
  out.write(header.data(), static_cast<std::streamsize>(header.size()));
  std::string row(bytes, '\0');
  for (std::uint32_t r = 0; r < shape.rows && out; ++r) {
    for (const std::uint32_t c : matrix.row(r)) row[c / 8] = static_cast<char>(row[c / 8] | 0x80 >> c % 8);
    out.write(row.data(), static_cast<std::streamsize>(row.size()));
    for (const std::uint32_t c : matrix.row(r)) row[c / 8] = 0;
  }
}

}  // namespace vismat
