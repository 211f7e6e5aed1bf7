// ALGORITHM. One strict reader a format fills a list of points and a list of polygons; indices are checked and polygons
// cut into triangles (by ears, in the plane of the polygon's Newell normal) once all is there, since an OBJ face may
// name a later point. What a file claims is never believed before as many bytes are there. Tried and found worse:
// OpenMesh 9's readers. Of damaged files they make other scenes without a word: an OBJ point that is not a number is
// left out and every later index means another point; a face with a wrong index, or one on two lines joined by a
// backslash, is left out; an OFF or STL file that is cut short loses or invents triangles; a count of 4e9 points ends
// in std::bad_alloc. Tests still read sound files through OpenMesh, as the judge of these readers.
#include "visibility/meshes/mesh_file.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "visibility/meshes/ply.h"
#include "visibility/meshes/polygons.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

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
    if (!(value >= 0 && value <= static_cast<double>(most_points) && value == std::floor(value))) {
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
    if (lower_case(word) != keyword) text.fail(shown(word) + " stands where " + keyword + " is due");
  };
  std::string_view word = text.word();
  do {
    expect("solid", word);
    text.next_line();  // the rest is its name
    while (lower_case(word = text.word()) == "facet") {
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
      lower_case(characters.substr(std::min(characters.find_first_not_of(" \t\r\n"), bytes.size()), 5));
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

}  // namespace

std::optional<MeshFormat> mesh_format(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
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
