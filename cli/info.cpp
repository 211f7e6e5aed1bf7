// vismat info: prints what a file of any kind holds; its first bytes tell the kind.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/vmat/container.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/dataset_file.h"
#include "matrix/files/hdf5_file.h"
#include "matrix/partition.h"
#include "programs/options.h"
#include "visibility/levels/level_file.h"
#include "visibility/scene_file.h"

namespace vismat::cli {
namespace {

void print_tree(const char* what, const ObjectTree& tree) {
  std::uint32_t leaves = 0, depth = 0, widest = 0;
  std::vector<std::uint32_t> depths(tree.size(), 0);
  for (std::uint32_t node = 0; node < tree.size(); ++node) {
    const auto children = static_cast<std::uint32_t>(tree.children(node).size());
    leaves += children == 0;
    widest = std::max(widest, children);
    if (node > 0) depths[node] = depths[tree.parent_of_node()[node]] + 1;
    depth = std::max(depth, depths[node]);
  }
  line(what, grouped(tree.size()) + " nodes over " + grouped(tree.object_count()) + " objects, " +
                 grouped(leaves) + " leaves, depth " + std::to_string(depth) + ", at most " +
                 std::to_string(widest) + " children");
}

void print_groups(const char* what, const std::optional<Partition>& groups) {
  if (groups) line(what, grouped(groups->groups()) + " groups of the source's " + grouped(groups->size()));
}

void print_source_map(const SourceMap& source) {
  if (!source.boundaries.empty()) line("boundaries", summary_of(source.boundaries));
  if (source.row_order || source.column_order) {
    const bool both = source.row_order == source.column_order;
    line("reordered", both                   ? "rows and columns, in the same order"
                      : !source.row_order    ? "columns"
                      : !source.column_order ? "rows"
                                             : "rows, columns");
  }
  print_groups("rows are", source.row_groups);
  print_groups("columns are", source.column_groups);
  std::string names;
  for (const auto& [there, what] :
       {std::pair(!source.row_names.empty(), "rows"), std::pair(!source.column_names.empty(), "columns")}) {
    if (there) names += (names.empty() ? "" : ", ") + std::string(what);
  }
  if (!names.empty()) line("names of", names);
  if (!source.column_levels.empty()) line("columns are", "levels of detail of objects");
  if (source.row_tree) print_tree("tree over rows", *source.row_tree);
  if (!source.tree) return line("tree", "none");
  print_tree("tree", *source.tree);
  if (source.columns_are_nodes) line("", "the columns are its nodes");
}

void print_size(Shape shape, std::uint64_t ones) {
  const double cells = static_cast<double>(shape.rows) * shape.columns;
  line("shape", grouped(shape.rows) + " rows x " + grouped(shape.columns) + " columns");
  line("ones", grouped(ones));
  line("density", formatted("%.2f %%", cells == 0 ? 0 : 100 * static_cast<double>(ones) / cells));
  line("bitmap", grouped(std::uint64_t{shape.rows} * ((std::uint64_t{shape.columns} + 7) / 8)) +
                     " bytes, rows aligned to bytes");
}

void print_dataset(const Dataset& dataset) {
  const VisibilityMatrix& matrix = dataset.matrix;
  print_size(matrix.shape(), matrix.ones());
  line("distinct", grouped(equal_rows(matrix).groups()) + " rows, " +
                       grouped(equal_rows(transpose(matrix)).groups()) + " columns");
  line("a row is a", dataset.rows_are);
  line("a column is a", dataset.columns_are);
  line("guarantee", std::string(to_string(dataset.guarantee)));
  line("provenance", dataset.provenance.empty() ? "unknown" : dataset.provenance);
  line("seed", dataset.seed ? std::to_string(*dataset.seed) : "none");
  std::string geometry;
  const auto add = [&](bool there, const std::string& name) {
    if (there) geometry += (geometry.empty() ? "" : ", ") + name;
  };
  add(!dataset.row_bounds.empty(), "row boxes");
  add(!dataset.column_bounds.empty(), "column boxes");
  if (dataset.row_neighbours)
    add(true, "row neighbours (" + grouped(dataset.row_neighbours->ones() / 2) + " pairs)");
  line("geometry", geometry.empty() ? "none" : geometry);
  print_source_map(dataset.source);
}

void print_scene(const SceneFile& file) {
  line("vertices", grouped(file.scene.vertices.size()));
  line("triangles", grouped(file.scene.indices.size() / 3));
  line("objects", grouped(file.scene.object_count));
  if (const auto& clear = file.scene.see_through; !clear.empty()) {
    line("see-through",
         grouped(static_cast<std::uint64_t>(std::count(clear.begin(), clear.end(), 1))) + " objects");
  }
  const auto range = formatted("%g to %g m above the ground", file.cells.eye_low, file.cells.eye_high);
  line("view cells", grouped(file.cells.count()) + (file.cells.prisms() == 0 ? "" : ", eyes " + range));
  line("neighbours", file.cells.neighbours ? grouped(file.cells.neighbours->ones() / 2) + " pairs" : "none");
  line("provenance", file.provenance.empty() ? "unknown" : file.provenance);
  line("seed", file.seed ? std::to_string(*file.seed) : "none");
  if (file.tree) {
    print_tree("tree", *file.tree);
  } else {
    line("tree", "none");
  }
}

void print_container(const Container& container, std::span<const std::byte> file) {
  print_size(container.shape, container.ones);
  line("codec", container.codec);
  const std::size_t payload = container.encoded.payload.size();
  const double ones = static_cast<double>(std::max<std::uint64_t>(container.ones, 1));
  line("payload", grouped(payload) + " bytes, " +
                      formatted("%.3f bits per one", 8 * static_cast<double>(payload) / ones));
  const ContainerHead head(file);
  using S = vmat::Section;
  for (const auto& [section, what] :
       {std::pair(S::index, "index"), std::pair(S::bands, "bands"), std::pair(S::row_order, "row order"),
        std::pair(S::column_order, "column order"), std::pair(S::shared_order, "order of both"),
        std::pair(S::row_groups, "row groups"), std::pair(S::column_groups, "column groups"),
        std::pair(S::boundaries, "boundaries"), std::pair(S::row_tree, "row tree"),
        std::pair(S::tree, "column tree"), std::pair(S::row_names, "row names"),
        std::pair(S::column_names, "column names"), std::pair(S::column_levels, "levels")}) {
    if (const std::size_t bytes = head.section(section).size(); bytes > 0)
      line(what, grouped(bytes) + " bytes");
  }
  if (container.boxes) line("encoded with", "the boxes of rows and columns, which a reader must have");
  print_source_map(container.source);
  std::istringstream facts(container.facts);
  for (std::string fact; std::getline(facts, fact);) line("fact", fact);
}

void print_level(const Level& level) {
  line("format", level.format);
  line("holds", summary(level));
  print_size(level.cells.shape(), level.cells.ones());
}

std::string first_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(8, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

void print_levels(const std::string& file) {
  const auto levels = list_levels(file);
  line("levels", std::to_string(levels.size()));
  for (const LevelListing& level : levels) {
    std::printf("%16s bytes  %s\n", grouped(level.bytes).c_str(), printable(level.where).c_str());
  }
}

// A path of a regular file, or FILE.pk3:MEMBER.
void print_info(const std::string& where) {
  std::error_code ignored;
  if (!std::filesystem::exists(where, ignored) && where.find(':') != std::string::npos) {
    const Level level = read_level(where);
    line("file", where + " (level)");
    return print_level(level);
  }
  const std::string begin = first_bytes(where);
  const auto title = [&](const char* kind) { line("file", where + " (" + kind + ")"); };
  if (begin.starts_with("IBSP")) {
    const Level level = read_level(where);
    title("level");
    print_level(level);
  } else if (begin.starts_with("PK") || begin.starts_with("IWAD") || begin.starts_with("PWAD")) {
    title("levels");
    print_levels(where);
  } else if (vmat::begins_vmat(std::as_bytes(std::span(begin)))) {
    const auto bytes = read_file(where);
    const Container container = naming(where, [&] { return read_container(bytes); });
    title("compressed matrix");
    print_container(container, bytes);
  } else if (is_hdf5(where) && naming(where, [&] { return Hdf5File::open(where).contains("/scene"); })) {
    const SceneFile scene = read_scene(where);
    title("scene");
    print_scene(scene);
  } else {
    const Dataset dataset = read_dataset(where);
    title(begin.starts_with("%%") ? "matrix, Matrix Market" : "matrix, Binsparse on HDF5");
    print_dataset(dataset);
  }
}

}  // namespace

void add_info(Program& program) {
  const auto file = std::make_shared<std::string>();
  const Verb verb =
      program.verb("info", "Print what a file holds: a matrix, a compressed matrix, a scene or levels");
  verb.input("FILE", *file,
             "The file (.bsp.h5, .mtx, .vmat, .scene.h5, .bsp, .pk3, .wad), or a level in one: FILE:MAP")
      .required();
  verb.example("vismat info koth1.bsp.h5");
  verb.example("vismat info pak6-patch085.pk3      (lists its levels)");
  verb.runs([file] { print_info(*file); });
}

}  // namespace vismat::cli
