// Text is read word by word, so that line ends mean nothing but behind names and colours. A binary file is told by its size: text
// may begin with any word, and the header of a binary file with "solid".
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "visibility/levels/ascii.h"
#include "visibility/meshes/mesh_readers.h"
#include "visibility/meshes/polygons.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

constexpr std::size_t stl_header = 84, stl_record = 50;

class StlText {
 public:
  StlText(std::string_view characters, const MeshPlacement& placement)
      : text_(characters, '\n', false), placement_(placement) {}

  MeshFile parse() {
    MeshFile file;
    next();
    do {
      if (!word_.starts_with("solid")) expect("solid");
      while (word_.starts_with("solid")) begin_solid();  // some exporters write the line twice
      while (word_ == "facet" || is_colour()) {
        if (word_ == "facet") facet();
      }
      do {
        if (!word_.starts_with("endsolid")) expect_end("solid");
        skip_line();
      } while (word_.starts_with("end"));
    } while (!word_.empty());
    file.leave_out(colours_, "colour lines");
    if (polygons_.points() == 0) throw FormatError("holds no triangles");
    polygons_.take(placement_, file);
    return file;
  }

 private:
  void begin_solid() {
    const std::string name = text_.rest_of_line();
    ++solids_;
    polygons_.begin_part({name.empty() ? "solid " + std::to_string(solids_) : name, ""});
    skip_line();
  }
  void facet() {
    next();
    expect("normal");
    // It follows from the corners, and is often wrong.
    for (int axis = 0; axis < 3 && word_ != "outer"; ++axis) next();
    while (is_colour()) {
    }
    expect("outer");
    expect("loop");
    polygons_.begin_face(text_.line());
    for (int corner = 0; corner < 3; ++corner) {
      if (word_ != "vertex") expect("vertex");
      polygons_.add_corner(polygons_.points());
      const Coordinates point = coordinates(text_, false);
      polygons_.add_point(point, text_.line(), [&](const std::string& what) { text_.fail(what); });
      next();
    }
    expect_end("loop");
    next();
    while (is_colour()) {
    }
    expect_end("facet");
    next();
  }
  void next() {
    original_ = text_.word();
    word_ = ascii_lower(original_);
  }
  void skip_line() {
    text_.next_line();
    next();
  }
  bool is_colour() {
    if (word_ != "color" && word_ != "colour") return false;
    ++colours_;
    skip_line();
    return true;
  }
  void expect(const std::string& keyword) {
    if (word_ != keyword) refuse(keyword);
    next();
  }
  /// Stays on the last word, since what follows endsolid is a name.
  void expect_end(const std::string& keyword) {
    if (word_ == "end" + keyword) return;
    if (word_ != "end" || ascii_lower(text_.word_of_line()) != keyword) refuse("end" + keyword);
  }
  [[noreturn]] void refuse(const std::string& keyword) {
    if (word_.empty()) text_.fail("the file ends where " + keyword + " is due");
    text_.fail(shown(original_) + " stands where " + keyword + " is due");
  }
  Text text_;
  Polygons polygons_{"line"};
  const MeshPlacement& placement_;
  std::uint64_t solids_ = 0;
  std::string_view original_;
  std::string word_;  // in lower case
  std::uint64_t colours_ = 0;
};

/// Where the records begin if the last two bytes of each tell how many bytes follow it; nothing if they do not fit the file.
std::optional<std::vector<std::size_t>> records_with_attributes(std::span<const std::byte> bytes,
                                                                std::uint64_t triangles) {
  std::vector<std::size_t> starts;
  std::size_t at = stl_header;
  for (std::uint64_t t = 0; t < triangles; ++t) {
    if (bytes.size() - at < stl_record) return {};
    starts.push_back(at);
    const std::size_t more = number_at<std::uint16_t>(bytes, at + stl_record - 2);
    if (bytes.size() - at - stl_record < more) return {};
    at += stl_record + more;
  }
  if (at != bytes.size()) return {};
  return starts;
}

MeshFile parse_binary_stl(std::span<const std::byte> bytes, const MeshPlacement& placement) {
  std::uint64_t triangles = number_at<std::uint32_t>(bytes, stl_header - 4);
  const std::size_t left = bytes.size() - stl_header;
  // Exporters that cannot go back to the header leave 0 or 0xffffffff there.
  if (triangles == 0 || triangles == 0xffffffff) {
    if (left % stl_record != 0) {
      throw FormatError("does not say how many triangles it has, and " + std::to_string(left) +
                        " bytes after the header are no whole number of them, each of 50");
    }
    triangles = left / stl_record;
  }
  if (triangles == 0) throw FormatError("holds no triangles");
  const std::uint64_t need = triangles * stl_record;
  if (left < need) {
    throw FormatError("says that it has " + std::to_string(triangles) + " triangles, which take " +
                      std::to_string(need + stl_header) + " bytes; it has " + std::to_string(bytes.size()));
  }
  MeshFile file;
  std::vector<std::size_t> starts;
  if (left > need) {
    auto found = records_with_attributes(bytes, triangles);
    file.leave_out(left - need, found ? "bytes of attributes" : "bytes after the last triangle");
    if (found) starts = std::move(*found);
  }
  Polygons polygons("triangle");
  for (std::uint64_t t = 0; t < triangles; ++t) {
    const std::size_t start = starts.empty() ? stl_header + t * stl_record : starts[t];
    std::array<float, 9> corners;
    std::memcpy(corners.data(), bytes.data() + start + 12, sizeof corners);
    polygons.begin_face(t);
    for (std::size_t c = 0; c < 9; c += 3) {
      polygons.add_corner(polygons.points());
      polygons.add_point({corners[c], corners[c + 1], corners[c + 2]}, [&](const std::string& what) {
        throw FormatError("triangle " + std::to_string(t) + ": " + what);
      });
    }
  }
  polygons.take(placement, file);
  return file;
}

}  // namespace

MeshFile parse_stl(std::span<const std::byte> bytes, const MeshPlacement& placement) {
  const bool fits = bytes.size() >= stl_header &&
                    bytes.size() - stl_header ==
                        std::uint64_t{number_at<std::uint32_t>(bytes, stl_header - 4)} * stl_record;
  if (!fits) {
    std::string storage;
    const std::string_view text =
        plain_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, storage);
    const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    if (ascii_lower(text.substr(first, 5)) == "solid" &&
        text.substr(0, 512).find('\0') == std::string_view::npos) {
      return StlText(text, placement).parse();
    }
  }
  if (bytes.size() < stl_header) {
    throw FormatError(
        "has " + std::to_string(bytes.size()) +
        " bytes; an STL file begins with the word solid or with 80 bytes and a number of triangles");
  }
  return parse_binary_stl(bytes, placement);
}

}  // namespace vismat
