// A header that describes elements, each with so many items of so many properties; then their numbers, as text or binary. What
// is not a vertex's place or the corners of a face or strip is read over.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/files/text.h"
#include "visibility/meshes/mesh_readers.h"
#include "visibility/meshes/polygons.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
PlyType ply_type(const Text& text, std::string_view word) {
  using enum PlyType;
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> names = {{{"char", i8},
                                                                           {"int8", i8},
                                                                           {"uchar", u8},
                                                                           {"uint8", u8},
                                                                           {"short", i16},
                                                                           {"int16", i16},
                                                                           {"ushort", u16},
                                                                           {"uint16", u16},
                                                                           {"int", i32},
                                                                           {"int32", i32},
                                                                           {"uint", u32},
                                                                           {"uint32", u32},
                                                                           {"float", f32},
                                                                           {"float32", f32},
                                                                           {"double", f64},
                                                                           {"float64", f64}}};
  for (const auto& [name, type] : names) {
    if (name == word) return type;
  }
  text.fail(shown(word) + " stands where a type, such as int or float, is due");
}

struct PlyProperty {
  enum class Role { unused, x, y, z, corners } role;
  PlyType type;
  std::optional<PlyType> count;  // of a list
};
struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;
};

class PlyNumbers {
 public:
  PlyNumbers(std::span<const std::byte> bytes, bool big_endian)
      : reader_(bytes, "its numbers"), big_(big_endian) {}
  explicit PlyNumbers(Text& text) : reader_({}, ""), text_(&text) {}

  double next(PlyType type) {
    if (text_ != nullptr) return text_->number(word_ = text_->word(), "a number");
    switch (type) {
      case PlyType::i8:
        return binary<std::int8_t>();
      case PlyType::u8:
        return binary<std::uint8_t>();
      case PlyType::i16:
        return binary<std::int16_t>();
      case PlyType::u16:
        return binary<std::uint16_t>();
      case PlyType::i32:
        return binary<std::int32_t>();
      case PlyType::u32:
        return binary<std::uint32_t>();
      case PlyType::f32:
        return binary<float>();
      case PlyType::f64:
        return binary<double>();
    }
    return 0;
  }
  /// What next() read, as text.
  std::string_view word() const { return word_; }
  std::uint64_t left() const { return reader_.left(); }
  [[noreturn]] void fail(const std::string& what) const {
    if (text_ != nullptr) text_->fail(what);
    reader_.fail(what);
  }
  std::uint64_t whole(PlyType type, const char* what) { return whole(next(type), what); }
  std::uint64_t whole(double value, const char* what) const {
    if (!(value >= 0 && value <= static_cast<double>(most_points) && value == std::floor(value))) {
      fail(std::string(what) + " is not a whole number from 0 to 4294967294");
    }
    return static_cast<std::uint64_t>(value);
  }

 private:
  template <typename Number>
  Number binary() {
    std::array<std::byte, sizeof(Number)> raw;
    std::copy_n(reader_.bytes(raw.size()).begin(), raw.size(), raw.begin());
    if (big_) std::reverse(raw.begin(), raw.end());
    Number number;
    std::memcpy(&number, raw.data(), raw.size());
    return number;
  }
  ByteReader reader_;
  Text* text_ = nullptr;
  std::string_view word_;
  bool big_ = false;
};

PlyProperty ply_property(Text& text, const std::string& element) {
  using enum PlyProperty::Role;
  PlyProperty property{unused, PlyType::f32, {}};
  std::string_view word = text.word_of_line();
  if (word == "list") {
    property.count = ply_type(text, text.word_of_line());
    word = text.word_of_line();
  }
  property.type = ply_type(text, word);
  const std::string_view name = text.word_of_line();
  if (name.empty()) text.fail("a property without a name");
  if (element == "vertex" && !property.count && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
    property.role = std::array{x, y, z}[name[0] - 'x'];
  }
  if ((element == "face" || element == "tristrips") && property.count &&
      (name == "vertex_indices" || name == "vertex_index")) {
    property.role = corners;
  }
  return property;
}

bool has(const PlyElement& element, PlyProperty::Role role) {
  return std::count_if(element.properties.begin(), element.properties.end(),
                       [&](const PlyProperty& property) { return property.role == role; }) == 1;
}

/// Cuts a strip into triangles, of which every second one is turned; -1 begins a new strip.
void add_strips(PlyNumbers& numbers, const PlyProperty& property, std::uint64_t strip, Polygons& polygons) {
  std::array<std::uint64_t, 2> last{};  // the corners of even and of odd number, which so turn by themselves
  std::uint64_t before = 0;
  for (std::uint64_t n = numbers.whole(*property.count, "a number of corners"); n > 0; --n) {
    const double value = numbers.next(property.type);
    if (value == -1 || value == 0xffffffff) {  // the same in unsigned numbers
      before = 0;
      continue;
    }
    const std::uint64_t corner = numbers.whole(value, "a corner's number");
    if (before >= 2) {
      polygons.begin_face(strip);
      for (const std::uint64_t point : {last[0], last[1], corner}) polygons.add_corner(point);
    }
    last[before++ % 2] = corner;
  }
}

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
};

PlyHeader ply_header(Text& text) {
  PlyHeader header;
  if (text.word_of_line() != "ply") text.fail("does not begin with ply");
  for (std::string_view word;;) {
    if (!text.next_line()) text.fail("the file ends before end_header");
    word = text.word_of_line();
    if (word == "end_header") break;
    if (word == "format") {
      header.format = text.word_of_line();
    } else if (word == "element") {
      const std::string name(text.word_of_line());
      const std::string_view number = text.word_of_line();
      const double count = text.number(number, "a number of elements");
      if (!(count >= 0 && count <= static_cast<double>(most_points) && count == std::floor(count))) {
        text.fail("claims " + shown(number) + " of " + shown(name) + "; at most 4294967294 are read");
      }
      header.elements.push_back({name, static_cast<std::uint64_t>(count), {}});
    } else if (word == "property") {
      if (header.elements.empty()) text.fail("a property before the first element");
      header.elements.back().properties.push_back(ply_property(text, header.elements.back().name));
    }
  }
  if (header.format != "ascii" && header.format != "binary_little_endian" &&
      header.format != "binary_big_endian") {
    text.fail("its format is " + shown(header.format) +
              "; ascii, binary_little_endian and binary_big_endian are read");
  }
  return header;
}

void check(const std::vector<PlyElement>& elements, std::uint64_t left) {
  using Role = PlyProperty::Role;
  for (const PlyElement& element : elements) {
    if (element.count > left || (element.count > 0 && element.properties.empty())) {
      throw FormatError("claims " + std::to_string(element.count) + " of " + shown(element.name) +
                        ", which the " + std::to_string(left) + " bytes after its header cannot hold");
    }
    left -= element.count;
    if (element.name == "vertex" &&
        !(has(element, Role::x) && has(element, Role::y) && has(element, Role::z))) {
      throw FormatError("its element vertex needs one x, one y and one z");
    }
    if (element.count > 0 && (element.name == "face" || element.name == "tristrips") &&
        !has(element, Role::corners)) {
      throw FormatError("its element " + element.name + " needs one list vertex_indices");
    }
  }
}

/// Where binary numbers begin: behind end_header and its line end. If the lines end with CR alone, LF is their first byte.
std::size_t after_header(std::string_view characters, const Text& text) {
  const std::size_t first = std::min(characters.find_first_of("\r\n"), characters.size());
  const bool cr_alone = characters.substr(first, 1) == "\r" && characters.substr(first, 2) != "\r\n";
  const std::size_t end = text.end_of_line();
  const bool both = !cr_alone && characters.substr(end, 2) == "\r\n";
  return std::min(end + (both ? 2 : 1), characters.size());
}

}  // namespace

MeshFile parse_ply(std::span<const std::byte> bytes, const MeshPlacement& placement) {
  using Role = PlyProperty::Role;
  std::string storage;
  const std::string_view characters = as_utf8(bytes, storage);
  Text text(characters, '\n', false);
  const auto [format, elements] = ply_header(text);
  const std::size_t start = after_header(characters, text);
  check(elements, characters.size() - start);
  const bool is_text = format == "ascii";
  text = Text(without_end_mark(characters.substr(start)), '\n', false, text.line() + 1);
  PlyNumbers numbers =
      is_text ? PlyNumbers(text)
              : PlyNumbers(std::as_bytes(std::span(characters.substr(start))), format == "binary_big_endian");
  Polygons polygons("face", is_text ? "the point of line" : "point");
  const auto fail = [&](const std::string& what) { numbers.fail(what); };
  MeshFile file;
  for (const PlyElement& element : elements) {
    if (element.name != "vertex" && element.name != "face" && element.name != "tristrips") {
      file.leave_out(element.count, "items of PLY's element " + shown(element.name));
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      Coordinates point;
      for (const PlyProperty& property : element.properties) {
        if (property.role == Role::corners && element.name == "tristrips") {
          add_strips(numbers, property, i, polygons);
        } else if (property.role == Role::corners) {
          polygons.begin_face(i);
          for (std::uint64_t n = numbers.whole(*property.count, "a number of corners"); n > 0; --n) {
            polygons.add_corner(numbers.whole(property.type, "a corner's number"));
          }
        } else if (property.count) {
          for (std::uint64_t n = numbers.whole(*property.count, "a list's length"); n > 0; --n)
            numbers.next(property.type);
        } else {
          const double value = numbers.next(property.type);
          if (property.role == Role::unused) continue;
          const auto axis = static_cast<std::size_t>(property.role) - static_cast<std::size_t>(Role::x);
          point.at[axis] = value;
          point.words[axis] = numbers.word();
        }
      }
      if (element.name == "vertex") {
        polygons.add_point(point, is_text ? text.line() : polygons.points(), fail);
      }
    }
  }
  if (is_text) {
    std::uint64_t words = 0;
    while (!text.word().empty()) ++words;
    file.leave_out(words, "words after the last element");
  } else {
    file.leave_out(numbers.left(), "bytes after the last element");
  }
  file.leave_out(polygons.unplaced(), "unused points that are not numbers within 1e9");
  polygons.take(placement, file);
  return file;
}

}  // namespace vismat
