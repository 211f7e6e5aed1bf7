// The folder that `vismat bake` makes: all that a walk through a scene needs.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codecs/vmat/row_reader.h"
#include "matrix/deltas.h"
#include "runtime/storage/chunk_store.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/scene_file.h"

namespace vismat {

/// One level of detail of an object, as the table of a baked scene has it.
struct Version {
  std::uint32_t object = 0, level = 0;  // level 0 is the finest
  std::uint32_t triangles = 0;
  double error = 0;  // metres, LevelOfDetail::error
  bool operator==(const Version&) const = default;
};
/// 20 bytes for each version, little-endian: object, level, triangles, error.
std::vector<std::byte> to_bytes(std::span<const Version> versions);
/// Throws FormatError unless these are versions of objects 0, 1, 2, ..., each with levels 0, 1, 2, ...
std::vector<Version> versions_from_bytes(std::span<const std::byte> bytes);

/// Names of the files in the folder.
namespace baked {
inline constexpr const char* scene = "scene.scene.h5";   // triangles, objects, view cells
inline constexpr const char* matrix = "cells.bsp.h5";    // view cells x versions of objects
inline constexpr const char* rows = "cells.vmat";        // the same, compressed
inline constexpr const char* lists = "boundaries.vmat";  // what appears and vanishes at each boundary
inline constexpr const char* geometry =
    "geometry.store";                                  // a chunk for each version, and one for their table
inline constexpr const char* facing = "facing.store";  // a chunk for each view cell
inline constexpr const char* summary = "bake.json";    // written last
inline constexpr const char* geometry_holds =
    "triangles of objects at levels of detail, then the table of these";
inline constexpr const char* facing_holds = "triangles that face each view cell, for each of its columns";
}  // namespace baked

/// A baked scene, open for reading. May be shared by threads.
class BakedScene {
 public:
  /// Throws std::runtime_error or FormatError, naming the file, if one is missing or damaged or belongs to another
  /// scene.
  explicit BakedScene(const std::filesystem::path& folder);

  const SceneFile& file() const { return file_; }
  std::uint32_t checksum() const { return checksum_; }  // checksum_of(file())
  const Screen& screen() const { return screen_; }      // for which levels were chosen
  std::span<const Box> cell_bounds() const { return cell_bounds_; }
  std::span<const Box> object_bounds() const { return object_bounds_; }

  /// All versions, ascending by object and level; chunk v of geometry() has the triangles of version v.
  std::span<const Version> versions() const { return versions_; }
  std::uint32_t first_version(std::uint32_t object) const { return first_version_[object]; }
  const ChunkStore& geometry() const { return geometry_; }

  /// Rows of cells; lists of boundaries. Columns of both are in the same order.
  const RowReader& rows() const { return rows_; }
  const RowReader& lists() const { return lists_; }
  std::uint32_t row_of_cell(std::uint32_t cell) const { return row_of_cell_[cell]; }
  std::uint32_t row_of_list(std::uint32_t list) const { return row_of_list_[list]; }
  std::uint32_t version_of_column(std::uint32_t column) const { return version_of_column_[column]; }
  std::span<const Boundary> boundaries() const { return boundaries_; }
  const BoundaryMap& map() const { return *map_; }
  /// The number of columns that a row or list has.
  std::uint32_t columns_of_cell(std::uint32_t cell) const { return columns_of_cell_[cell]; }
  std::uint32_t columns_of_list(std::uint32_t list) const { return columns_of_list_[list]; }

  /// For each object the coarsest version that deviates by less than a pixel, seen from anywhere in the cell.
  std::vector<std::uint32_t> versions_from(std::uint32_t cell) const;
  /// For each column that is visible from the cell, ascending, how many of its triangles may face the cell.
  std::vector<std::uint32_t> facing(std::uint32_t cell) const;
  /// The scene's objects, of which only these versions have triangles. Reads them.
  Scene scene_of(std::span<const std::uint32_t> versions) const;

 private:
  std::filesystem::path folder_;
  SceneFile file_;
  std::uint32_t checksum_;
  Screen screen_;
  double per_radian_ = 0;
  ChunkStore geometry_, facing_;
  RowReader rows_, lists_;
  std::vector<Version> versions_;
  std::vector<std::uint32_t> first_version_, version_of_column_, row_of_cell_, row_of_list_, columns_of_cell_,
      columns_of_list_;
  std::vector<Box> cell_bounds_, object_bounds_;
  std::vector<Boundary> boundaries_;
  std::optional<BoundaryMap> map_;
};

}  // namespace vismat
