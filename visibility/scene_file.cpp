#include "visibility/scene_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/base/checksum.h"
#include "matrix/files/hdf5_file.h"
#include "matrix/files/hdf5_names.h"

namespace vismat {
namespace {

constexpr std::uint64_t file_version = 2;  // 1 had neither boxes nor what is seen through
constexpr float farthest = 1e9f;           // metres; keeps all that is computed from coordinates finite

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw FormatError(name + ": " + what);
}

std::string entry(const std::string& name, std::size_t index) {
  return name + ", entry " + std::to_string(index);
}

void write_points(Hdf5File& file, const std::string& name, const std::vector<glm::vec3>& points) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const std::span<const float> numbers(points.empty() ? nullptr : &points[0].x, 3 * points.size());
  file.write(name, numbers, {points.size(), 3});
}

std::vector<glm::vec3> read_points(const Hdf5File& file, const std::string& name) {
  const std::vector<std::uint64_t> dimensions = file.dimensions(name);
  if (dimensions.size() != 2 || dimensions[1] != 3) refuse(name, "need a table with 3 columns: x, y, z");
  const std::vector<float> numbers = file.read<float>(name);
  std::vector<glm::vec3> points(numbers.size() / 3);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!(std::abs(numbers[i]) <= farthest)) {
      refuse(entry(name, i / 3), "a coordinate is not a number within 1e9 m of the origin");
    }
    points[i / 3][static_cast<int>(i % 3)] = numbers[i];
  }
  if (points.size() >= ObjectTree::none) refuse(name, "more than 2^32 - 2 points");
  return points;
}

std::vector<Box> read_boxes(const Hdf5File& file, const std::string& name) {
  const std::vector<std::uint64_t> dimensions = file.dimensions(name);
  if (dimensions.size() != 2 || dimensions[1] != 6)
    refuse(name, "need a table with 6 columns: low x, y, z, high x, y, z");
  const std::vector<float> numbers = file.read<float>(name);
  std::vector<Box> boxes(numbers.size() / 6);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float low = numbers[6 * i + axis], high = numbers[6 * i + 3 + axis];
      if (!(low >= -farthest && low <= high && high <= farthest)) {
        refuse(entry(name, i), "need a low and a high corner within 1e9 m of the origin");
      }
      boxes[i].low[axis] = low;
      boxes[i].high[axis] = high;
    }
  }
  if (boxes.size() >= ObjectTree::none) refuse(name, "more than 2^32 - 2 boxes");
  return boxes;
}

std::vector<std::uint32_t> read_ids(const Hdf5File& file, const std::string& name, std::uint64_t bound,
                                    const char* of_what) {
  std::vector<std::uint32_t> ids = file.read<std::uint32_t>(name);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= bound) {
      refuse(entry(name, i),
             std::string(of_what) + " " + std::to_string(ids[i]) + " of only " + std::to_string(bound));
    }
  }
  return ids;
}

std::uint64_t need_number(const Hdf5File& file, const std::string& object, const std::string& name) {
  const std::optional<std::uint64_t> number = file.number_attribute(object, name);
  if (!number)
    refuse(object, "attribute " + name + " is missing; is this a scene file made by 'vismat city'?");
  return *number;
}

Scene scene_from(const Hdf5File& file) {
  Scene scene;
  const std::uint64_t objects = need_number(file, "/scene", "object_count");
  if (objects >= ObjectTree::none) refuse("/scene", "object_count is not below 2^32 - 1");
  scene.object_count = static_cast<std::uint32_t>(objects);
  scene.vertices = read_points(file, "/scene/vertices");
  scene.indices = read_ids(file, "/scene/triangles", scene.vertices.size(), "vertex");
  scene.object_of_triangle = read_ids(file, "/scene/object_of_triangle", objects, "object");
  if (scene.indices.size() != 3 * scene.object_of_triangle.size()) {
    refuse("/scene/object_of_triangle", std::to_string(scene.object_of_triangle.size()) + " entries for " +
                                            std::to_string(scene.indices.size()) +
                                            " corners of triangles; need one for three");
  }
  // Whoever reads the scene makes room for every object, so their number must be backed by bytes of the file.
  if (scene.object_count > scene.object_of_triangle.size()) {
    refuse("/scene", "object_count " + std::to_string(objects) + " but only " +
                         std::to_string(scene.object_of_triangle.size()) +
                         " triangles; an object needs at least one");
  }
  if (file.contains("/scene/see_through")) {
    scene.see_through = file.read<std::uint8_t>("/scene/see_through");
    if (scene.see_through.size() != scene.object_count) {
      refuse("/scene/see_through", std::to_string(scene.see_through.size()) +
                                       " entries; need one for each of " +
                                       std::to_string(scene.object_count) + " objects");
    }
  }
  scene.object_names = read_names(file, "/scene/object_names");
  if (!scene.object_names.empty() && scene.object_names.size() != scene.object_count) {
    refuse("/scene/object_names", std::to_string(scene.object_names.size()) +
                                      " names; need one for each of " + std::to_string(scene.object_count) +
                                      " objects");
  }
  return scene;
}

std::array<double, 3> origin_from(const Hdf5File& file) {
  std::array<double, 3> origin{};
  const std::optional<std::string> text = file.string_attribute("/scene", "origin");
  if (!text) return origin;
  const char *at = text->data(), *end = at + text->size();
  for (double& x : origin) {
    const auto [after, error] = std::from_chars(at, end, x);
    if (error != std::errc() || !(std::abs(x) <= 1e15))
      refuse("/scene", "origin must be three numbers, x,y,z");
    at = std::min(after + 1, end);
  }
  return origin;
}

std::string text_of(const std::array<double, 3>& origin) {
  std::array<char, 100> text;
  std::snprintf(text.data(), text.size(), "%.17g,%.17g,%.17g", origin[0], origin[1], origin[2]);
  return text.data();
}

ViewCells cells_from(const Hdf5File& file) {
  ViewCells cells;
  if (!file.contains("/cells/corners") && !file.contains("/cells/boxes")) return cells;
  if (file.contains("/cells/corners")) cells.corners = read_points(file, "/cells/corners");
  if (cells.corners.size() % 3 != 0) {
    refuse("/cells/corners", std::to_string(cells.corners.size()) + " points; need three a cell");
  }
  const std::vector<float> eyes = file.contains("/cells/eye_heights") || cells.prisms() > 0
                                      ? file.read<float>("/cells/eye_heights")
                                      : std::vector{cells.eye_low, cells.eye_high};
  if (eyes.size() != 2 || !(eyes[0] >= -farthest && eyes[0] <= eyes[1] && eyes[1] <= farthest)) {
    refuse("/cells/eye_heights", "need two heights within 1e9 m of the ground, the lower first");
  }
  cells.eye_low = eyes[0];
  cells.eye_high = eyes[1];
  if (file.contains("/cells/boxes")) cells.boxes = read_boxes(file, "/cells/boxes");
  if (file.contains("/cells/neighbour_offsets")) {
    const std::vector<std::uint64_t> offsets = file.read<std::uint64_t>("/cells/neighbour_offsets");
    const std::vector<std::uint32_t> ids = file.read<std::uint32_t>("/cells/neighbours");
    try {
      cells.neighbours = VisibilityMatrix::from_csr({cells.count(), cells.count()}, offsets, ids);
    } catch (const std::invalid_argument& error) {
      refuse("/cells/neighbours", error.what());
    }
    if (transpose(*cells.neighbours) != *cells.neighbours) {
      refuse("/cells/neighbours", "a cell has a neighbour that does not have it in return");
    }
  }
  return cells;
}

}  // namespace

SceneFile read_scene(const std::filesystem::path& path) {
  try {
    const Hdf5File file = Hdf5File::open(path);
    if (!file.contains("/scene")) {
      throw FormatError(file.groups_with("binsparse").empty()
                            ? "holds no scene: it has no group /scene"
                            : "holds a matrix, not a scene; 'vismat info' tells what it is of");
    }
    if (const auto version = need_number(file, "/scene", "version"); version == 0 || version > file_version) {
      refuse("/scene", "version " + std::to_string(version) + "; this program reads versions 1 and 2");
    }
    SceneFile result;
    result.scene = scene_from(file);
    result.cells = cells_from(file);
    if (file.contains("/tree")) {
      try {
        result.tree = ObjectTree::from_parents(file.read<std::uint32_t>("/tree/parent_of_node"),
                                               file.read<std::uint32_t>("/tree/object_of_node"),
                                               result.scene.object_count);
      } catch (const std::invalid_argument& error) {
        refuse("/tree", error.what());
      }
    }
    result.provenance = file.string_attribute("/scene", "provenance").value_or("");
    result.seed = file.number_attribute("/scene", "seed");
    result.origin = origin_from(file);
    result.opacity_unknown = file.number_attribute("/scene", "opacity_unknown").value_or(0) != 0;
    return result;
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

void write_scene(const std::filesystem::path& path, const SceneFile& contents) {
  write_hdf5(path, [&](Hdf5File& file) {
    const Scene& scene = contents.scene;
    const ViewCells& cells = contents.cells;
    const auto write_ids = [&](const std::string& name, std::span<const std::uint32_t> ids) {
      file.write(name, ids, {ids.size()});
    };
    write_points(file, "/scene/vertices", scene.vertices);
    file.write<std::uint32_t>("/scene/triangles", scene.indices, {scene.indices.size() / 3, 3});
    write_ids("/scene/object_of_triangle", scene.object_of_triangle);
    if (!scene.see_through.empty()) {
      file.write<std::uint8_t>("/scene/see_through", scene.see_through, {scene.see_through.size()});
    }
    file.write_attribute("/scene", "version", file_version);
    file.write_attribute("/scene", "object_count", std::uint64_t{scene.object_count});
    file.write_attribute("/scene", "provenance", contents.provenance);
    if (contents.seed) file.write_attribute("/scene", "seed", *contents.seed);
    write_names(file, "/scene/object_names", scene.object_names);
    if (contents.origin != std::array<double, 3>{})
      file.write_attribute("/scene", "origin", text_of(contents.origin));
    if (contents.opacity_unknown) file.write_attribute("/scene", "opacity_unknown", std::uint64_t{1});
    write_points(file, "/cells/corners", cells.corners);
    file.write<float>("/cells/eye_heights", std::array{cells.eye_low, cells.eye_high}, {2});
    if (!cells.boxes.empty()) {
      static_assert(sizeof(Box) == 6 * sizeof(float));
      file.write("/cells/boxes", std::span<const float>(cells.boxes[0].low.data(), 6 * cells.boxes.size()),
                 {cells.boxes.size(), 6});
    }
    if (cells.neighbours) {
      const auto offsets = cells.neighbours->offsets();
      file.write("/cells/neighbour_offsets", offsets, {offsets.size()});
      write_ids("/cells/neighbours", cells.neighbours->ids());
    }
    if (contents.tree) {
      write_ids("/tree/parent_of_node", contents.tree->parent_of_node());
      write_ids("/tree/object_of_node", contents.tree->object_of_node());
    }
  });
}

std::uint32_t checksum_of(const SceneFile& file) {
  const Scene& scene = file.scene;
  std::vector<std::uint32_t> parts;
  const auto add = [&](const auto& values) { parts.push_back(crc32(std::as_bytes(std::span(values)))); };
  add(scene.vertices), add(scene.indices), add(scene.object_of_triangle), add(scene.see_through);
  add(file.cells.corners), add(file.cells.boxes), add(std::array{file.cells.eye_low, file.cells.eye_high});
  return crc32(std::as_bytes(std::span(parts)));
}

}  // namespace vismat
