#include "runtime/walks/baked_scene.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "runtime/walks/level_geometry.h"

namespace vismat {
namespace {

struct Summary {
  std::uint32_t checksum = 0;
  Screen screen;
};

Summary read_summary(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) {
    throw std::runtime_error(
        path.string() + ": cannot be read; 'vismat bake SCENE -o FOLDER' makes it when all else is done");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(in);
    Summary summary;
    summary.checksum = json.at("scene_checksum").get<std::uint32_t>();
    summary.screen = {json.at("screen").at("width").get<std::uint32_t>(),
                      json.at("screen").at("height").get<std::uint32_t>(),
                      json.at("screen").at("field_of_view").get<float>()};
    pixels_per_radian(summary.screen);
    return summary;
  } catch (const std::exception& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

/// Throws FormatError if the file was made of another scene.
void check_scene(const std::filesystem::path& path, std::uint32_t is, std::uint32_t right) {
  if (is != right) {
    throw FormatError(path.string() + ": belongs to another scene (its checksum is " + std::to_string(is) +
                      ", the scene's " + std::to_string(right) + ")");
  }
}

/// How many columns each row has; 0 for one that is damaged.
std::vector<std::uint32_t> lengths_of(const RowReader& reader) {
  std::vector<std::uint32_t> lengths(reader.shape().rows);
  RowBuffer<std::uint32_t> buffer;
  for (std::uint32_t row = 0; row < lengths.size(); ++row) {
    try {
      lengths[row] = static_cast<std::uint32_t>(reader.ids(row, buffer).size());
    } catch (const FormatError&) {  // whoever needs the row is told
    }
  }
  return lengths;
}

std::vector<std::uint32_t> identity(std::uint32_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

std::vector<std::uint32_t> of_each(const std::vector<std::uint32_t>& place,
                                   const std::vector<std::uint32_t>& values) {
  std::vector<std::uint32_t> result(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) result[i] = values[place[i]];
  return result;
}

}  // namespace

std::vector<std::byte> to_bytes(std::span<const Version> versions) {
  std::vector<std::byte> bytes;
  bytes.reserve(20 * versions.size());
  const auto put = [&](const auto& value) {
    const auto raw = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  for (const Version& v : versions) put(v.object), put(v.level), put(v.triangles), put(v.error);
  return bytes;
}

std::vector<Version> versions_from_bytes(std::span<const std::byte> bytes) {
  ByteReader reader(bytes, "table of levels of detail");
  std::vector<Version> versions;
  versions.reserve(bytes.size() / 20);
  while (reader.left() > 0) {
    Version v;
    v.object = reader.number<std::uint32_t>();
    v.level = reader.number<std::uint32_t>();
    v.triangles = reader.number<std::uint32_t>();
    v.error = reader.number<double>();
    const bool next_level =
        !versions.empty() && v.object == versions.back().object && v.level == versions.back().level + 1;
    const bool next_object = v.level == 0 && v.object == (versions.empty() ? 0 : versions.back().object + 1);
    if (!next_level && !next_object) reader.fail("objects and their levels do not follow one another");
    if (!(v.error >= 0)) reader.fail("an error is no length");
    versions.push_back(v);
  }
  return versions;
}

BakedScene::BakedScene(const std::filesystem::path& folder)
    : folder_(folder),
      file_(read_scene(folder / baked::scene)),
      checksum_(checksum_of(file_)),
      geometry_(folder / baked::geometry),
      facing_(folder / baked::facing),
      rows_(folder / baked::rows),
      lists_(folder / baked::lists) {
  const Summary summary = read_summary(folder / baked::summary);
  check_scene(folder / baked::summary, summary.checksum, checksum_);
  check_scene(folder / baked::geometry, geometry_.scene_checksum(), checksum_);
  check_scene(folder / baked::facing, facing_.scene_checksum(), checksum_);
  screen_ = summary.screen;
  per_radian_ = pixels_per_radian(screen_);
  cell_bounds_ = vismat::cell_bounds(file_.cells);
  object_bounds_ = vismat::object_bounds(file_.scene);

  naming(folder / baked::geometry, [&] {
    if (geometry_.count() == 0) throw FormatError("has no chunks");
    const std::uint32_t table = geometry_.count() - 1;
    std::vector<std::byte> bytes(geometry_.bytes(table));
    geometry_.read(table, bytes);
    versions_ = versions_from_bytes(bytes);
    if (versions_.size() != table) {
      throw FormatError("has " + std::to_string(table) + " chunks of triangles, but its table has " +
                        std::to_string(versions_.size()) + " levels of detail");
    }
  });
  for (std::uint32_t v = 0; v < versions_.size(); ++v) {
    if (versions_[v].level == 0) first_version_.push_back(v);
  }
  const auto objects = static_cast<std::uint32_t>(first_version_.size());
  if (objects != file_.scene.object_count) {
    throw FormatError((folder / baked::geometry).string() + ": has " + std::to_string(objects) +
                      " objects, but the scene has " + std::to_string(file_.scene.object_count));
  }
  first_version_.push_back(static_cast<std::uint32_t>(versions_.size()));

  const SourceMap of_rows = rows_.source(), of_lists = lists_.source();
  const std::uint32_t cells = file_.cells.count();
  naming(folder / baked::rows, [&] {
    if (rows_.shape().rows != cells || facing_.count() != cells) {
      throw FormatError("has " + std::to_string(rows_.shape().rows) + " rows, but the scene has " +
                        std::to_string(cells) + " view cells");
    }
    if (of_rows.row_groups || of_rows.column_groups) throw FormatError("its rows or columns are merged");
    if (of_rows.column_levels.size() != rows_.shape().columns) {
      throw FormatError("does not say which level of detail of which object each column is");
    }
  });
  naming(folder / baked::lists, [&] {
    if (lists_.shape().columns != rows_.shape().columns || of_lists.column_order != of_rows.column_order ||
        of_lists.column_levels != of_rows.column_levels) {
      throw FormatError(std::string("its columns are not those of ") + baked::rows);
    }
  });
  boundaries_ = of_lists.boundaries;
  map_.emplace(boundaries_);
  row_of_cell_ = of_rows.row_order ? std::vector(of_rows.row_order->new_of_old().begin(),
                                                 of_rows.row_order->new_of_old().end())
                                   : identity(cells);
  row_of_list_ = of_lists.list_rows ? std::vector(of_lists.list_rows->group_of_member().begin(),
                                                  of_lists.list_rows->group_of_member().end())
                                    : identity(lists_.shape().rows);
  columns_of_cell_ = of_each(row_of_cell_, lengths_of(rows_));
  columns_of_list_ = of_each(row_of_list_, lengths_of(lists_));
  version_of_column_.resize(rows_.shape().columns);
  for (std::uint32_t column = 0; column < version_of_column_.size(); ++column) {
    const auto [object, level] = of_rows.column_levels[column];
    if (object >= objects || level >= first_version_[object + 1] - first_version_[object]) {
      throw FormatError((folder / baked::rows).string() + ": column " + std::to_string(column) +
                        " is level " + std::to_string(level) + " of object " + std::to_string(object) +
                        ", which the table of levels lacks");
    }
    const std::uint32_t present = of_rows.column_order ? of_rows.column_order->new_of_old()[column] : column;
    version_of_column_[present] = first_version_[object] + level;
  }
}

std::vector<std::uint32_t> BakedScene::versions_from(std::uint32_t cell) const {
  std::vector<std::uint32_t> chosen(object_bounds_.size());
  for (std::uint32_t object = 0; object < chosen.size(); ++object) {
    std::uint32_t version = first_version_[object + 1] - 1;
    while (version > first_version_[object] &&
           deviation_in_pixels(versions_[version].error, cell_bounds_[cell], object_bounds_[object],
                               per_radian_) >= 1) {
      --version;
    }
    chosen[object] = version;
  }
  return chosen;
}

std::vector<std::uint32_t> BakedScene::facing(std::uint32_t cell) const {
  return naming(folder_ / baked::facing, [&] {
    std::vector<std::uint32_t> counts(columns_of_cell_.at(cell));
    if (facing_.bytes(cell) != 4 * counts.size()) {
      throw FormatError("chunk " + std::to_string(cell) + " has not 4 bytes for each column of the cell");
    }
    facing_.read(cell, std::as_writable_bytes(std::span(counts)));
    return counts;
  });
}

Scene BakedScene::scene_of(std::span<const std::uint32_t> versions) const {
  Scene scene;
  scene.object_count = file_.scene.object_count;
  scene.see_through = file_.scene.see_through;
  std::vector<std::byte> bytes;
  for (const std::uint32_t version : versions) {
    bytes.resize(geometry_.bytes(version));
    geometry_.read(version, bytes);
    const LevelGeometry geometry = geometry_from_chunk(bytes);
    const auto base = static_cast<std::uint32_t>(scene.vertices.size());
    scene.vertices.insert(scene.vertices.end(), geometry.vertices.begin(), geometry.vertices.end());
    for (const auto& triangle : geometry.triangles) {
      for (const std::uint32_t corner : triangle) scene.indices.push_back(base + corner);
      scene.object_of_triangle.push_back(versions_[version].object);
    }
  }
  return scene;
}

}  // namespace vismat
