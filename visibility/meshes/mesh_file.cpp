// ALGORITHM. One strict reader a format fills a list of points and a list of polygons; indices are checked and polygons
// cut into triangles once all is there, since an OBJ face may
// name a later point. What a file claims is never believed before as many bytes are there. Tried and found worse:
// OpenMesh 9's readers. Of damaged files they make other scenes without a word: an OBJ point that is not a number is
// left out and every later index means another point; a face with a wrong index, or one on two lines joined by a
// backslash, is left out; an OFF or STL file that is cut short loses or invents triangles; a count of 4e9 points ends
// in std::bad_alloc. Tests still read sound files through OpenMesh, as the judge of these readers.
#include "visibility/meshes/mesh_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/gzip.h"
#include "visibility/levels/ascii.h"
#include "visibility/meshes/mesh_readers.h"
#include "visibility/meshes/polygons.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

using namespace std::literals;

/// OBJ's keywords that say nothing of where surfaces are.
constexpr std::array obj_attributes = {"vt"sv,       "vn"sv,       "s"sv,          "mg"sv,
                                       "usemap"sv,   "maplib"sv,   "lod"sv,        "bevel"sv,
                                       "c_interp"sv, "d_interp"sv, "shadow_obj"sv, "trace_obj"sv};

MeshFile parse_obj(std::span<const std::byte> bytes, const MeshPlacement& placement) {
  MeshFile file;
  std::uint64_t lines = 0, others = 0;
  std::string other, storage;
  Text text(plain_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, storage), '#', true);
  Polygons polygons("line");
  const auto fail = [&](const std::string& what) { text.fail(what); };
  std::string object, group, material;
  const auto begin_part = [&] {
    polygons.begin_part({object.empty() || group.empty() ? object + group : object + "/" + group, material});
  };
  do {
    const std::string_view keyword = text.word_of_line();
    if (keyword == "v") {
      const std::uint64_t line = text.line();
      polygons.add_point(coordinates(text, true), line, fail);
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
    } else if (keyword == "o") {
      object = text.rest_of_line(), group.clear(), begin_part();
    } else if (keyword == "g") {
      group = text.rest_of_line(), begin_part();
    } else if (keyword == "usemtl") {
      material = text.rest_of_line(), begin_part();
    } else if (keyword == "mtllib") {
      file.material_files.push_back(text.rest_of_line());
    } else if (keyword == "l" || keyword == "p") {
      ++lines;
    } else if (!keyword.empty() && std::ranges::find(obj_attributes, keyword) == obj_attributes.end()) {
      if (others++ == 0) other = shown(keyword);
    }
  } while (text.next_line());
  file.leave_out(polygons.unplaced(), "unused points that are not numbers within 1e9");
  file.leave_out(lines, "lines and single points");
  file.leave_out(others, "lines of other kinds (" + other + " first)");
  polygons.take(placement, file);
  return file;
}

}  // namespace

std::optional<MeshFormat> mesh_format(const std::filesystem::path& path) {
  std::string ending = ascii_lower(path.extension().string());
  if (ending == ".gz") ending = ascii_lower(path.stem().extension().string());
  if (ending == ".obj") return MeshFormat::obj;
  if (ending == ".ply") return MeshFormat::ply;
  if (ending == ".off") return MeshFormat::off;
  if (ending == ".stl") return MeshFormat::stl;
  return {};
}

MeshFile parse_mesh(std::span<const std::byte> bytes, MeshFormat format, const MeshPlacement& placement) {
  if (bytes.empty()) throw FormatError("is empty");
  if (is_gzip(bytes)) {
    std::uint64_t after_end = 0;
    const std::vector<std::byte> unpacked =
        gunzip(bytes, (std::uint64_t{16} << 20) + 100 * bytes.size(), &after_end);
    if (is_gzip(unpacked)) throw FormatError("is packed by gzip twice; unpack it by gunzip");
    MeshFile file = parse_mesh(unpacked, format, placement);
    file.leave_out(after_end, "bytes after the packed data");
    return file;
  }
  switch (format) {
    case MeshFormat::obj:
      return parse_obj(bytes, placement);
    case MeshFormat::ply:
      return parse_ply(bytes, placement);
    case MeshFormat::off:
      return parse_off(bytes, placement);
    case MeshFormat::stl:
      return parse_stl(bytes, placement);
  }
  return {};
}

MeshFile read_mesh(const std::filesystem::path& path, const MeshPlacement& placement) {
  const std::optional<MeshFormat> format = mesh_format(path);
  if (!format) {
    throw std::invalid_argument(path.string() +
                                ": a mesh file ends in .obj, .ply, .off or .stl, perhaps before .gz");
  }
  const std::vector<std::byte> bytes = read_file(path);
  return naming(path, [&] { return parse_mesh(bytes, *format, placement); });
}

}  // namespace vismat
