// ALGORITHM. One strict reader a format fills a list of points and a list of polygons; indices are checked and polygons cut into
// triangles (by ears, in the plane of the polygon's Newell normal) once all is there, since an OBJ face may name a later point.
// What a file claims is never believed before as many bytes are there. Tried and lost: OpenMesh 9's readers. Of damaged files
// they make other scenes without a word: an OBJ point that is not a number is left out and every later index means another
// point; a face with a wrong index, or one on two lines joined by a backslash, is left out; an OFF or STL file
// that is cut short loses or invents triangles; a count of 4e9 points ends in std::bad_alloc. Tests still read sound
// files through OpenMesh, as the judge of these readers.
#include "visibility/mesh_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "matrix/atomic_file.h"
#include "matrix/byte_reader.h"

namespace vismat {
namespace {

constexpr double farthest = 1e9;
constexpr std::uint64_t most = 0xfffffffe;  // points, triangles
constexpr std::size_t most_corners = 4096;

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

/// As it may stand in a message: short and printable.
std::string shown(std::string_view word) {
  std::string result = "'";
  for (const char c : word.substr(0, 24)) result += c > ' ' && c <= '~' ? c : '?';
  return result + (word.size() > 24 ? "...'" : "'");
}

/// Words and lines of a text, counted from 1.
class Text {
 public:
  /// `comment` starts one that ends with the line, unless it is '\n'; lines may go on after a backslash if `continued`.
  Text(std::string_view text, char comment, bool continued)
      : text_(text), comment_(comment), continued_(continued) {}

  /// The next word of this line; empty at its end.
  std::string_view word_of_line() {
    for (;;) {
      if (at_ == text_.size() || text_[at_] == '\n') return {};
      if (text_[at_] == comment_) {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (const std::size_t next = continued_ ? after_line_joint() : at_; next != at_) {
        at_ = next;
        ++line_;
      } else if (is_space(text_[at_])) {
        ++at_;
      } else {
        break;
      }
    }
    const std::size_t first = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != comment_ &&
           !(continued_ && after_line_joint() != at_)) {
      ++at_;
    }
    return text_.substr(first, at_ - first);
  }
  /// To the start of the next line; false at the end of the text.
  bool next_line() {
    at_ = std::min(text_.find('\n', at_), text_.size());
    if (at_ == text_.size()) return false;
    ++at_;
    ++line_;
    return true;
  }
  /// The next word on whichever line; empty at the end.
  std::string_view word() {
    for (;;) {
      if (const std::string_view found = word_of_line(); !found.empty()) return found;
      if (!next_line()) return {};
    }
  }
  double number(std::string_view word, const char* what) const {
    double value = 0;
    const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range) {  // tells not whether too small or too large
      return lower(digits).find("e-") != std::string::npos ? 0 : std::numeric_limits<double>::infinity();
    }
    if (word.empty()) fail(std::string("ends where ") + what + " is due");
    if (error != std::errc() || end != digits.data() + digits.size()) {
      fail(shown(word) + " stands where " + what + " is due");
    }
    return value;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw FormatError("line " + std::to_string(line_) + ": " + message);
  }
  std::uint64_t line() const { return line_; }
  std::size_t offset() const { return at_; }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  std::size_t after_line_joint() const {
    if (text_[at_] != '\\') return at_;
    if (text_.substr(at_ + 1, 1) == "\n") return at_ + 2;
    return text_.substr(at_ + 1, 2) == "\r\n" ? at_ + 3 : at_;
  }
  std::string_view text_;
  char comment_;
  bool continued_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 1;
};

// -- polygons into triangles ----------------------------------------------------------------------------------------------

class EarCutter {
 public:
  void cut(std::span<const std::uint32_t> polygon, const std::vector<glm::vec3>& points,
           std::vector<std::uint32_t>& triangles) {
    flatten(polygon, points);
    left_.resize(polygon.size());
    for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = static_cast<std::uint32_t>(i);
    std::size_t at = 0, failed = 0;
    while (left_.size() > 3) {
      const std::size_t size = left_.size(), before = (at + size - 1) % size, after = (at + 1) % size;
      // One that crosses itself, or is flat, has no ears left: then any corner will do.
      if (failed == size || is_ear(left_[before], left_[at], left_[after])) {
        for (const std::size_t i : {before, at, after}) triangles.push_back(polygon[left_[i]]);
        left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
        at = at == size - 1 ? 0 : at;
        failed = 0;
      } else {
        at = after;
        ++failed;
      }
    }
    for (const std::uint32_t i : left_) triangles.push_back(polygon[i]);
  }

 private:
  void flatten(std::span<const std::uint32_t> polygon, const std::vector<glm::vec3>& points) {
    glm::dvec3 normal(0);
    const glm::dvec3 origin = points[polygon[0]];
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      normal += glm::cross(glm::dvec3(points[polygon[i]]) - origin,
                           glm::dvec3(points[polygon[(i + 1) % polygon.size()]]) - origin);
    }
    int axis = 0;  // along which the polygon looks largest
    for (const int other : {1, 2}) {
      if (std::abs(normal[other]) > std::abs(normal[axis])) axis = other;
    }
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    flat_.clear();
    for (const std::uint32_t point : polygon) {
      const glm::dvec3 place = points[point];
      flat_.emplace_back(place[u], normal[axis] < 0 ? -place[v] : place[v]);
    }
  }
  double turn(std::size_t a, std::size_t b, std::size_t c) const {
    const glm::dvec2 ab = flat_[b] - flat_[a], ac = flat_[c] - flat_[a];
    return ab.x * ac.y - ab.y * ac.x;
  }
  bool is_ear(std::size_t a, std::size_t b, std::size_t c) const {
    if (!(turn(a, b, c) > 0)) return false;
    return std::none_of(left_.begin(), left_.end(), [&](std::uint32_t i) {
      if (flat_[i] == flat_[a] || flat_[i] == flat_[b] || flat_[i] == flat_[c]) return false;
      return turn(a, b, i) >= 0 && turn(b, c, i) >= 0 && turn(c, a, i) >= 0;
    });
  }
  std::vector<glm::dvec2> flat_;
  std::vector<std::uint32_t> left_;
};

// -- what every format fills ----------------------------------------------------------------------------------------------

class Polygons {
 public:
  /// `place` names faces in messages: "line" if begin_face is given lines, "face" if numbers.
  explicit Polygons(const char* place) : place_(place) {}

  template <typename Fail>
  void add_point(const std::array<double, 3>& at, const Fail& fail) {
    if (points_.size() == most) fail("more than 4294967294 points");
    for (const double x : at) {
      if (!(std::abs(x) <= farthest)) fail("a coordinate is not a number within 1e9 of the origin");
    }
    points_.emplace_back(at[0], at[1], at[2]);
  }
  std::size_t points() const { return points_.size(); }

  void begin_face(std::uint64_t where) {
    where_.push_back(where);
    first_corner_.push_back(corners_.size());
  }
  /// `point` counts from 0 and may name one that comes later.
  void add_corner(std::uint64_t point) {
    corners_.push_back(static_cast<std::uint32_t>(std::min(point, most)));
  }

  Scene take() {
    Scene scene;
    if (points_.empty()) throw FormatError("holds no points");
    EarCutter cutter;
    for (std::size_t face = 0; face < where_.size(); ++face) {
      const std::size_t end = face + 1 < where_.size() ? first_corner_[face + 1] : corners_.size();
      const std::span<const std::uint32_t> corners =
          std::span(corners_).subspan(first_corner_[face], end - first_corner_[face]);
      for (const std::uint32_t corner : corners) {
        if (corner >= points_.size()) {
          fail(face,
               "names a point that is not among the " + std::to_string(points_.size()) + " of the file");
        }
      }
      if (corners.empty()) fail(face, "a face without corners");
      if (corners.size() > most_corners) {
        fail(face, "a face of " + std::to_string(corners.size()) + " corners; at most 4096 are read");
      }
      if (corners.size() > 3) {
        cutter.cut(corners, points_, scene.indices);
      } else {
        for (std::size_t i = 0; i < 3; ++i) scene.indices.push_back(corners[std::min(i, corners.size() - 1)]);
      }
      if (scene.indices.size() / 3 > most) fail(face, "more than 4294967294 triangles");
    }
    if (scene.indices.empty())
      throw FormatError("holds " + std::to_string(points_.size()) + " points but no faces");
    scene.vertices = std::move(points_);
    scene.object_of_triangle.assign(scene.indices.size() / 3, 0);
    scene.object_count = 1;
    return scene;
  }

 private:
  [[noreturn]] void fail(std::size_t face, const std::string& what) const {
    throw FormatError(std::string(place_) + " " + std::to_string(where_[face]) + ": " + what);
  }
  const char* place_;
  std::vector<glm::vec3> points_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint64_t> first_corner_, where_;
};

/// Three numbers of a text, on one line or wherever they stand.
std::array<double, 3> coordinates(Text& text, bool of_line) {
  std::array<double, 3> at;
  for (double& x : at) x = text.number(of_line ? text.word_of_line() : text.word(), "a coordinate");
  return at;
}

// -- the formats ----------------------------------------------------------------------------------------------------------

Scene parse_obj(std::string_view bytes) {
  Text text(bytes, '#', true);
  Polygons polygons("line");
  const auto fail = [&](const std::string& what) { text.fail(what); };
  do {
    const std::string_view keyword = text.word_of_line();
    if (keyword == "v") {
      polygons.add_point(coordinates(text, true), fail);
    } else if (keyword == "f" || keyword == "fo") {  // fo: what f was called once
      polygons.begin_face(text.line());
      for (std::string_view word; !(word = text.word_of_line()).empty();) {
        const std::string_view position = word.substr(0, word.find('/'));
        std::int64_t index = 0;
        const auto [end, error] = std::from_chars(position.data(), position.data() + position.size(), index);
        if (error != std::errc() || end != position.data() + position.size()) {
          text.fail(shown(word) + " stands where a corner, such as 7 or 7/1/2, is due");
        }
        if (index == 0) text.fail("names point 0; points count from 1, or back from -1");
        const auto points = static_cast<std::int64_t>(polygons.points());
        if (index < -points) {
          text.fail("names point " + std::to_string(index) + ", but only " + std::to_string(points) +
                    " stand before it");
        }
        polygons.add_corner(static_cast<std::uint64_t>(index > 0 ? index - 1 : index + points));
      }
    } else if (keyword == "surf" || keyword == "curv") {
      text.fail("holds free-form curves or surfaces; export polygons");
    }
  } while (text.next_line());
  return polygons.take();
}

Scene parse_off(std::string_view bytes) {
  Text text(bytes, '#', false);
  Polygons polygons("line");
  const auto fail = [&](const std::string& what) { text.fail(what); };
  const std::string_view magic = text.word();
  if (magic != "OFF" && magic != "COFF" && magic != "NOFF" && magic != "CNOFF" && magic != "STOFF") {
    text.fail("begins with " + shown(magic) +
              "; need OFF (or COFF, NOFF, CNOFF, STOFF) with points of three coordinates");
  }
  const auto count = [&](std::string_view word, const char* what) {
    const double value = text.number(word, what);
    if (!(value >= 0 && value <= static_cast<double>(most) && value == std::floor(value))) {
      text.fail(shown(word) + " stands where " + what + " below 4294967295 is due");
    }
    return static_cast<std::uint64_t>(value);
  };
  std::string_view first = text.word();
  if (first == "BINARY") text.fail("is a binary OFF file; only text is read");
  const std::uint64_t points = count(first, "the number of points"),
                      faces = count(text.word(), "the number of faces");
  const auto next = [&](std::string_view word, std::uint64_t done, std::uint64_t all, const char* what) {
    if (word.empty())
      text.fail("the file ends after " + std::to_string(done) + " of " + std::to_string(all) + what);
    return word;
  };
  text.next_line();
  for (std::uint64_t i = 0; i < points; ++i) {
    std::array<double, 3> at;
    at[0] = text.number(next(text.word(), i, points, " points"), "a coordinate");
    for (const int axis : {1, 2}) at[axis] = text.number(text.word_of_line(), "a coordinate");
    polygons.add_point(at, fail);
    text.next_line();
  }
  for (std::uint64_t i = 0; i < faces; ++i) {
    const std::uint64_t corners = count(next(text.word(), i, faces, " faces"), "a number of corners");
    polygons.begin_face(text.line());
    for (std::uint64_t k = 0; k < corners; ++k)
      polygons.add_corner(count(text.word_of_line(), "a point's number"));
    text.next_line();
  }
  if (const std::string_view more = text.word(); !more.empty()) {
    text.fail(shown(more) + " stands after the last of " + std::to_string(faces) + " faces");
  }
  return polygons.take();
}

Scene parse_text_stl(std::string_view bytes) {
  Text text(bytes, '\n', false);
  Polygons polygons("line");
  const auto fail = [&](const std::string& what) { text.fail(what); };
  const auto expect = [&](const char* keyword, std::string_view word) {
    if (word.empty()) text.fail(std::string("the file ends where ") + keyword + " is due");
    if (lower(word) != keyword) text.fail(shown(word) + " stands where " + keyword + " is due");
  };
  std::string_view word = text.word();
  do {
    expect("solid", word);
    text.next_line();  // the rest is its name
    while (lower(word = text.word()) == "facet") {
      expect("normal", text.word());
      for (int axis = 0; axis < 3; ++axis) text.word();  // follows from the corners, and is often wrong
      expect("outer", text.word());
      expect("loop", text.word());
      polygons.begin_face(text.line());
      for (int corner = 0; corner < 3; ++corner) {
        expect("vertex", text.word());
        polygons.add_corner(polygons.points());
        polygons.add_point(coordinates(text, false), fail);
      }
      expect("endloop", text.word());
      expect("endfacet", text.word());
    }
    expect("endsolid", word);
    text.next_line();
  } while (!(word = text.word()).empty());
  return polygons.take();
}

Scene parse_stl(std::span<const std::byte> bytes) {
  const std::string_view characters(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::size_t header = 80, record = 50;
  std::uint32_t triangles = 0;
  if (bytes.size() >= header + 4) std::memcpy(&triangles, bytes.data() + header, 4);
  const std::uint64_t need = header + 4 + std::uint64_t{triangles} * record;
  const std::string start =
      lower(characters.substr(std::min(characters.find_first_not_of(" \t\r\n"), bytes.size()), 5));
  // A binary file's header may begin with "solid" too.
  if (bytes.size() != need && start == "solid" &&
      characters.substr(0, 512).find('\0') == std::string_view::npos) {
    return parse_text_stl(characters);
  }
  if (bytes.size() < header + 4) {
    throw FormatError(
        "has " + std::to_string(bytes.size()) +
        " bytes; an STL file begins with the word solid or with 80 bytes and a number of triangles");
  }
  if (bytes.size() != need) {
    throw FormatError("says that it has " + std::to_string(triangles) + " triangles, which take " +
                      std::to_string(need) + " bytes; it has " + std::to_string(bytes.size()));
  }
  Polygons polygons("triangle");
  for (std::uint32_t t = 0; t < triangles; ++t) {
    std::array<float, 9> corners;
    std::memcpy(corners.data(), bytes.data() + header + 4 + std::size_t{t} * record + 12, sizeof corners);
    polygons.begin_face(t);
    for (std::size_t c = 0; c < 9; c += 3) {
      polygons.add_corner(polygons.points());
      polygons.add_point({corners[c], corners[c + 1], corners[c + 2]}, [&](const std::string& what) {
        throw FormatError("triangle " + std::to_string(t) + ": " + what);
      });
    }
  }
  return polygons.take();
}

// -- PLY: a header that describes elements, then their numbers --------------------------------------------------------------

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
    if (!(value >= 0 && value <= static_cast<double>(most) && value == std::floor(value))) {
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
      if (!(count >= 0 && count <= static_cast<double>(most) && count == std::floor(count))) {
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

}  // namespace

std::optional<MeshFormat> mesh_format(const std::filesystem::path& path) {
  const std::string ending = lower(path.extension().string());
  if (ending == ".obj") return MeshFormat::obj;
  if (ending == ".ply") return MeshFormat::ply;
  if (ending == ".off") return MeshFormat::off;
  if (ending == ".stl") return MeshFormat::stl;
  return {};
}

Scene parse_mesh(std::span<const std::byte> bytes, MeshFormat format) {
  if (bytes.empty()) throw FormatError("is empty");
  const std::string_view characters(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  switch (format) {
    case MeshFormat::obj:
      return parse_obj(characters);
    case MeshFormat::ply:
      return parse_ply(bytes);
    case MeshFormat::off:
      return parse_off(characters);
    case MeshFormat::stl:
      return parse_stl(bytes);
  }
  return {};
}

Scene read_mesh(const std::filesystem::path& path) {
  const std::optional<MeshFormat> format = mesh_format(path);
  if (!format) throw std::invalid_argument(path.string() + ": a mesh file ends in .obj, .ply, .off or .stl");
  const std::vector<std::byte> bytes = read_file(path);
  try {
    return parse_mesh(bytes, *format);
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

}  // namespace vismat
