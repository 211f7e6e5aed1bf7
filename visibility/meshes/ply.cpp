// A header that describes elements, each with so many items of so many properties; then their numbers, as text or binary. What
// is not a vertex's place or a face's corners is read over.
#include "visibility/meshes/ply.h"

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
    if (text_ != nullptr) return text_->number(text_->word(), "a number");
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
  [[noreturn]] void fail(const std::string& what) const {
    if (text_ != nullptr) text_->fail(what);
    reader_.fail(what);
  }
  std::uint64_t whole(PlyType type, const char* what) {
    const double value = next(type);
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
  if (element == "face" && property.count && (name == "vertex_indices" || name == "vertex_index")) {
    property.role = corners;
  }
  return property;
}

bool has(const PlyElement& element, PlyProperty::Role role) {
  return std::count_if(element.properties.begin(), element.properties.end(),
                       [&](const PlyProperty& property) { return property.role == role; }) == 1;
}

}  // namespace

Scene parse_ply(std::span<const std::byte> bytes) {
  using Role = PlyProperty::Role;
  const std::string_view characters(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Text text(characters, '\n', false);
  if (text.word_of_line() != "ply") text.fail("does not begin with ply");
  std::string format;
  std::vector<PlyElement> elements;
  for (std::string_view word;;) {
    if (!text.next_line()) text.fail("the file ends before end_header");
    word = text.word_of_line();
    if (word == "end_header") break;
    if (word == "format") {
      format = text.word_of_line();
    } else if (word == "element") {
      const std::string name(text.word_of_line());
      const std::string_view number = text.word_of_line();
      const double count = text.number(number, "a number of elements");
      if (!(count >= 0 && count <= static_cast<double>(most_points) && count == std::floor(count))) {
        text.fail("claims " + shown(number) + " of " + shown(name) + "; at most 4294967294 are read");
      }
      elements.push_back({name, static_cast<std::uint64_t>(count), {}});
    } else if (word == "property") {
      if (elements.empty()) text.fail("a property before the first element");
      elements.back().properties.push_back(ply_property(text, elements.back().name));
    }
  }
  if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
    text.fail("its format is " + shown(format) +
              "; ascii, binary_little_endian and binary_big_endian are read");
  }
  text.next_line();
  const bool is_text = format == "ascii";
  std::uint64_t left = bytes.size() - text.offset();
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
    if (element.name == "face" && element.count > 0 && !has(element, Role::corners)) {
      throw FormatError("its element face needs one list vertex_indices");
    }
  }
  PlyNumbers numbers =
      is_text ? PlyNumbers(text) : PlyNumbers(bytes.subspan(text.offset()), format == "binary_big_endian");
  Polygons polygons("face");
  for (const PlyElement& element : elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      std::array<double, 3> at{};
      for (const PlyProperty& property : element.properties) {
        if (property.role == Role::corners) {
          polygons.begin_face(i);
          for (std::uint64_t n = numbers.whole(*property.count, "a number of corners"); n > 0; --n) {
            polygons.add_corner(numbers.whole(property.type, "a corner's number"));
          }
        } else if (property.count) {
          for (std::uint64_t n = numbers.whole(*property.count, "a list's length"); n > 0; --n)
            numbers.next(property.type);
        } else {
          const double value = numbers.next(property.type);
          if (property.role != Role::unused)
            at[static_cast<int>(property.role) - static_cast<int>(Role::x)] = value;
        }
      }
      if (element.name == "vertex")
        polygons.add_point(at, [&](const std::string& what) { numbers.fail(what); });
    }
  }
  return polygons.take();
}

}  // namespace vismat
