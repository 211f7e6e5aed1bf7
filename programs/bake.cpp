// ALGORITHM. Levels of detail, then the visibility of each cell over the scene at its levels; an order of its columns, by which
// geometry lies on disk and rows and lists are coded; then the differences between neighbouring cells.
#include "programs/bake.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>

#include "codecs/vmat/container.h"
#include "layout/best_order.h"
#include "matrix/base/atomic_file.h"
#include "matrix/deltas.h"
#include "matrix/files/dataset_file.h"
#include "programs/measuring.h"
#include "programs/names.h"
#include "runtime/storage/chunk_store.h"
#include "runtime/walks/baked_scene.h"
#include "runtime/walks/level_geometry.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat {
namespace {

/// Throws std::invalid_argument if the folder holds what belongs to another scene.
void check_folder(const std::filesystem::path& folder, std::uint32_t checksum) {
  const std::filesystem::path old = folder / baked::scene;
  if (!std::filesystem::exists(old)) return;
  if (checksum_of(read_scene(old)) != checksum) {
    throw std::invalid_argument(folder.string() +
                                ": holds another scene or other view cells; choose an empty folder");
  }
}

/// One of ours that decodes single rows of any matrix. Throws std::invalid_argument, which lists the names, if it is none.
const Codec& row_codec(const std::string& name) {
  std::string names;
  for (const Codec& codec : own_codecs()) {
    if (codec.open == nullptr || codec.needs.tree != TreeOver::nothing || codec.needs.boxes) continue;
    if (codec.name == name) return codec;
    names += (names.empty() ? "" : ", ") + std::string(codec.name);
  }
  throw std::invalid_argument("codec '" + name +
                              "' is none of those that decode single rows of any matrix: " + names);
}

class Bake {
 public:
  Bake(const SceneFile& scene, const BakeOptions& options, JobRunner& runner)
      : scene_(scene),
        options_(options),
        runner_(runner),
        checksum_(checksum_of(scene)),
        producer_(producer_named(options.producer)),
        codec_(row_codec(options.codec)),
        line_(describe(scene, options)) {
    if (producer_.see_levels == nullptr) {
      throw std::invalid_argument("the producer " + options.producer +
                                  " cannot see levels of detail; shadow can");
    }
  }

  std::vector<BakedPart> run() {
    const std::filesystem::path& folder = options_.folder;
    if (runner_.leads()) {
      check_folder(folder, checksum_);
      std::filesystem::create_directories(folder);
      // The summary says that all is there, so it goes first and comes last.
      std::filesystem::remove(folder / baked::summary);
      part(baked::scene, [&](const std::filesystem::path& path) { write_scene(path, scene_); });
    }
    begin_ = wall_seconds();
    const LevelsOfDetail levels(scene_.scene, options_.screen, options_.visibility.threads,
                                begin_stage(stages(), "simplifying objects"));
    tell("levels of detail", 0);
    see(levels);
    if (!runner_.leads()) return {};
    write_rows_and_lists();
    write_geometry(levels);
    write_facing(levels);
    part(baked::summary, [&](const std::filesystem::path& path) { write_summary(path); });
    return std::move(parts_);
  }

 private:
  Stages stages() const { return runner_.leads() ? options_.stages : Stages{}; }

  void tell(const std::string& name, std::uint64_t bytes) {
    parts_.push_back({name, wall_seconds() - begin_, bytes});
    begin_ = wall_seconds();
  }

  template <typename Write>
  void part(const char* name, const Write& write) {
    begin_ = wall_seconds();
    const std::filesystem::path path = options_.folder / name;
    write(path);
    tell(name, std::filesystem::file_size(path));
  }

  void see(const LevelsOfDetail& levels) {
    const std::filesystem::path path = options_.folder / baked::matrix;
    if (runner_.leads() && std::filesystem::exists(path)) {
      matrix_ = read_dataset(path);
      if (matrix_.provenance == line_) {
        tell(baked::matrix, std::filesystem::file_size(path));
        return;
      }
    }
    LevelSight sight =
        producer_.see_levels(scene_.scene, levels, scene_.cells, options_.visibility, runner_, stages());
    if (!runner_.leads()) return;
    matrix_ = {};
    matrix_.matrix = producer_.listed(sight.sight);
    matrix_.columns_are = "object at a level of detail";
    matrix_.provenance = line_;
    matrix_.guarantee = producer_.guarantee;
    matrix_.seed = options_.visibility.seed.value_or(1);
    matrix_.row_bounds = cell_bounds(scene_.cells);
    matrix_.column_bounds = std::move(sight.column_bounds);
    matrix_.row_neighbours =
        scene_.cells.neighbours ? *scene_.cells.neighbours : touching_boxes(matrix_.row_bounds);
    matrix_.source.column_levels = std::move(sight.columns);
    write_dataset(path, matrix_);
    tell(baked::matrix, std::filesystem::file_size(path));
  }

  void write_rows_and_lists() {
    begin_ = wall_seconds();
    order_ = best_order(matrix_.matrix, {.threads = options_.visibility.threads, .stages = stages()});
    tell("order of columns", 0);
    Dataset rows = reordered(matrix_, Permutation::identity(matrix_.matrix.shape().rows), order_);
    in_order_ = rows.matrix;
    Deltas deltas = deltas_of(rows.matrix, *rows.row_neighbours);
    part(baked::rows, [&](const std::filesystem::path& path) { write_coded(path, rows); });
    Dataset lists;
    lists.matrix = std::move(deltas.lists);
    lists.source = rows.source;
    lists.source.boundaries = std::move(deltas.boundaries);
    part(baked::lists, [&](const std::filesystem::path& path) { write_coded(path, lists); });
  }

  void write_coded(const std::filesystem::path& path, const Dataset& data) const {
    EncodeOptions encode;
    encode.threads = options_.visibility.threads;
    encode.rows_may_move = true;
    // Not prepared_for(): a column that stood for several versions would be of no use to a viewer.
    Container container = compress(data.matrix, codec_, data.source, encode);
    container.facts = "scene checksum: " + std::to_string(checksum_);
    write_file(path, write_container(container));
  }

  /// Versions in the order of the columns, then those that no cell sees, then the table of all.
  void write_geometry(const LevelsOfDetail& levels) {
    std::vector<Version> versions;
    first_version_.clear();
    for (std::uint32_t object = 0; object < scene_.scene.object_count; ++object) {
      first_version_.push_back(static_cast<std::uint32_t>(versions.size()));
      const std::span<const LevelOfDetail> of_object = levels.levels(object);
      for (std::uint32_t level = 0; level < of_object.size(); ++level) {
        versions.push_back({object, level, static_cast<std::uint32_t>(of_object[level].triangles.size()),
                            of_object[level].error});
      }
    }
    std::vector<std::uint32_t> on_disk;
    std::vector<char> placed(versions.size(), 0);
    for (const std::uint32_t column : order_.old_of_new()) {
      const auto [object, level] = matrix_.source.column_levels[column];
      on_disk.push_back(first_version_[object] + level);
      placed[on_disk.back()] = 1;
    }
    for (std::uint32_t v = 0; v < versions.size(); ++v) {
      if (placed[v] == 0) on_disk.push_back(v);
    }
    part(baked::geometry, [&](const std::filesystem::path& path) {
      ChunkStoreWriter store(path, baked::geometry_holds, checksum_,
                             static_cast<std::uint32_t>(versions.size()) + 1);
      for (const std::uint32_t v : on_disk) {
        const Version& version = versions[v];
        store.append(v, to_chunk(geometry_of(levels.mesh(version.object),
                                             levels.levels(version.object)[version.level])));
      }
      store.append(static_cast<std::uint32_t>(versions.size()), to_bytes(versions));
      store.finish();
    });
  }

  void write_facing(const LevelsOfDetail& levels) {
    const std::vector<Box> cells = cell_bounds(scene_.cells);
    const std::vector<std::uint32_t> old_of_new = order_.old_of_new();
    std::vector<std::vector<std::uint32_t>> counts(cells.size());
    parallel_for(
        cells.size(), options_.visibility.threads,
        [&](std::uint64_t cell) {
          for (const std::uint32_t column : in_order_.row(static_cast<std::uint32_t>(cell))) {
            const auto [object, level] = matrix_.source.column_levels[old_of_new[column]];
            counts[cell].push_back(
                static_cast<std::uint32_t>(levels.facing_triangles(cells[cell], object, level)));
          }
        },
        begin_stage(stages(), "counting triangles"));
    part(baked::facing, [&](const std::filesystem::path& path) {
      ChunkStoreWriter store(path, baked::facing_holds, checksum_, static_cast<std::uint32_t>(cells.size()));
      for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
        store.append(cell, std::as_bytes(std::span(counts[cell])));
      }
      store.finish();
    });
  }

  void write_summary(const std::filesystem::path& path) const {
    const nlohmann::ordered_json json = {{"scene_checksum", checksum_},
                                         {"made", line_},
                                         {"screen",
                                          {{"width", options_.screen.width},
                                           {"height", options_.screen.height},
                                           {"field_of_view", options_.screen.field_of_view}}},
                                         {"codec", codec_.name},
                                         {"objects", scene_.scene.object_count},
                                         {"view_cells", scene_.cells.count()},
                                         {"columns", matrix_.matrix.shape().columns},
                                         {"ones", matrix_.matrix.ones()}};
    const std::string text = json.dump(2) + "\n";
    write_file(path, std::as_bytes(std::span(text)));
  }

  const SceneFile& scene_;
  const BakeOptions& options_;
  JobRunner& runner_;
  std::uint32_t checksum_;
  const Producer& producer_;
  const Codec& codec_;
  std::string line_;
  double begin_ = 0;
  std::vector<BakedPart> parts_;
  Dataset matrix_;
  Permutation order_;
  VisibilityMatrix in_order_;  // matrix_'s, with columns in that order
  std::vector<std::uint32_t> first_version_;
};

}  // namespace

std::string describe(const SceneFile& scene, const BakeOptions& options) {
  return producer_named(options.producer).describe_levels(options.visibility, options.screen) + "; of " +
         scene.provenance;
}

std::vector<BakedPart> bake(const SceneFile& scene, const BakeOptions& options, JobRunner& runner) {
  return Bake(scene, options, runner).run();
}

}  // namespace vismat
