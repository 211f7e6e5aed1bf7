// ALGORITHM. OFF's definition takes line ends for blanks, but for the colours behind a face; yet most files have a point and a
// face on each line, often with more numbers behind a point than the first word says. So a file with as many lines as points and
// faces is read line by line. Otherwise the first word tells how many numbers a point has, and the first of these ways of reading
// that fits the whole file counts.
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "visibility/levels/ascii.h"
#include "visibility/meshes/mesh_readers.h"
#include "visibility/meshes/polygons.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

struct OffHeader {
  std::uint64_t points = 0, faces = 0;
  std::vector<std::size_t> words_of_point = {3};  // likeliest first
};

/// How a file is laid out: where its points begin, and what ends with a line.
struct OffLayout {
  Text start;
  std::size_t words_of_point = 0;  // 0: those of its line
  enum class Face { line, colours_of_line, any_lines } face;
};

std::uint64_t off_count(const Text& text, std::string_view word, const char* what) {
  const double value = text.number(word, what);
  if (!(value >= 0 && value <= static_cast<double>(most_points) && value == std::floor(value))) {
    text.fail(shown(word) + " stands where " + what + " below 4294967295 is due");
  }
  return static_cast<std::uint64_t>(value);
}

/// Reads the first word, if it is one of those that OFF files begin with, and gives what is glued to it.
std::string_view read_off_keyword(Text& text, OffHeader& header) {
  const Text before = text;
  const std::string_view word = text.word();
  if (!word.empty() && word.find_first_not_of("+.0123456789") == std::string_view::npos) {
    text = before;  // the word may be left out
    return {};
  }
  std::string capitals(word);
  if (ascii_lower(word) == word) {
    for (char& c : capitals) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  std::string_view rest = capitals;
  const auto take = [&](std::string_view prefix) {
    const bool found = rest.starts_with(prefix);
    if (found) rest.remove_prefix(prefix.size());
    return found;
  };
  std::size_t words = 3;
  bool colours = false, other = false;
  for (bool found = true; found;) {
    const bool texture = take("ST"), normal = take("N"), colour = take("C"),
               dimensions = take("4") || take("n");
    words += (texture ? 2u : 0u) + (normal ? 3u : 0u);
    colours |= colour;
    other |= dimensions;
    found = texture || normal || colour || dimensions;
  }
  if (!take("OFF") || rest.find_first_not_of("0123456789") != std::string_view::npos) {
    text.fail("begins with " + shown(word) +
              "; need OFF (or COFF, NOFF, STOFF, NCOFF and so on) with points of three coordinates");
  }
  if (other) text.fail("begins with " + shown(word) + "; only points of three coordinates are read");
  header.words_of_point = colours ? std::vector{words + 4, words + 3} : std::vector{words};
  return word.substr(word.size() - rest.size());
}

/// Whether the text has as many lines as points and faces, each point on its own.
bool has_a_line_each(Text text, const OffHeader& header) {
  std::uint64_t lines = 0;
  do {
    std::size_t words = 0;
    while (words < 3 && !text.word_of_line().empty()) ++words;
    if (words == 0) continue;
    if (lines++ < header.points && words < 3) return false;
  } while (text.next_line());
  return lines == header.points + header.faces;
}

std::vector<OffLayout> off_layouts(const OffHeader& header, Text text) {
  // The number of edges, which means nothing, may be missing or stand on the next line.
  std::vector<Text> starts;
  if (!text.word_of_line().empty()) {
    starts.push_back(text);
  } else {
    Text after = text;
    if (!after.word().empty() && after.word_of_line().empty()) starts.push_back(after);
    starts.push_back(text);
  }
  for (Text line : starts) {
    line.next_line();
    if (has_a_line_each(line, header)) return {{line, 0, OffLayout::Face::line}};
  }
  std::vector<OffLayout> layouts;
  for (const auto face : {OffLayout::Face::colours_of_line, OffLayout::Face::any_lines}) {
    for (const Text& start : starts) {
      for (const std::size_t words : header.words_of_point) layouts.push_back({start, words, face});
      Text line = start;
      line.next_line();
      layouts.push_back({line, 0, face});
    }
  }
  return layouts;
}

Polygons read_off(const OffHeader& header, const OffLayout& layout) {
  Text text = layout.start;
  Polygons polygons("line");
  const auto fail = [&](const std::string& what) { text.fail(what); };
  const auto next = [&](std::uint64_t done, std::uint64_t all, const char* what) {
    const std::string_view word = text.word();
    if (word.empty()) {
      text.fail("the file ends after " + std::to_string(done) + " of " + std::to_string(all) + what);
    }
    return word;
  };
  const bool of_line = layout.words_of_point == 0;
  for (std::uint64_t i = 0; i < header.points; ++i) {
    Coordinates point;
    std::uint64_t line = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::string_view& word = point.words[axis];
      word = axis == 0 ? next(i, header.points, " points") : of_line ? text.word_of_line() : text.word();
      if (axis == 0) line = text.line();
      point.at[axis] = text.number(word, "a coordinate");
    }
    for (std::size_t more = 3; more < layout.words_of_point; ++more)
      text.number(text.word(), "a normal or colour");
    polygons.add_point(point, line, fail);
    if (of_line) text.next_line();
  }
  for (std::uint64_t i = 0; i < header.faces; ++i) {
    const std::uint64_t corners = off_count(text, next(i, header.faces, " faces"), "a number of corners");
    // Where lines do not tell, numbers that are no faces must not be taken for faces of a file that is cut short.
    if (corners < 3 && layout.face != OffLayout::Face::line) text.fail("a face of less than three corners");
    polygons.begin_face(text.line());
    for (std::uint64_t k = 0; k < corners; ++k) {
      const bool face_of_line = layout.face == OffLayout::Face::line;
      const std::string_view word = face_of_line ? text.word_of_line() : text.word();
      polygons.add_corner(off_count(text, word, "a point's number"));
    }
    if (layout.face != OffLayout::Face::any_lines) text.next_line();
  }
  if (const std::string_view more = text.word(); !more.empty()) {
    text.fail(shown(more) + " stands after the last of " + std::to_string(header.faces) + " faces");
  }
  return polygons;
}

}  // namespace

MeshFile parse_off(std::span<const std::byte> bytes, const MeshPlacement& placement) {
  std::string storage;
  Text text(plain_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, storage), '#', false);
  OffHeader header;
  std::string_view first = read_off_keyword(text, header);
  if (first.empty()) first = text.word();
  if (first == "BINARY") text.fail("is a binary OFF file; only text is read");
  header.points = off_count(text, first, "the number of points");
  header.faces = off_count(text, text.word(), "the number of faces");
  std::optional<FormatError> refusal;  // of the likeliest layout
  for (const OffLayout& layout : off_layouts(header, text)) {
    try {
      Polygons polygons = read_off(header, layout);
      MeshFile file;
      file.leave_out(polygons.unplaced(), "unused points that are not numbers within 1e9");
      polygons.take(placement, file);
      return file;
    } catch (const FormatError& error) {
      if (!refusal) refusal = error;
    }
  }
  throw *refusal;
}

}  // namespace vismat
