// vismat info: prints what a file of any kind holds; its first bytes tell the kind.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
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
#include "matrix/base/byte_reader.h"
#include "matrix/files/dataset_file.h"
#include "matrix/files/hdf5_file.h"
#include "matrix/partition.h"
#include "programs/options.h"
#include "visibility/levels/level_file.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/scene_file.h"

namespace vismat::cli {
namespace {

constexpr std::size_t most_names = 10;  // that are shown

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
  if (source.list_rows)
    line("rows are", grouped(source.list_rows->groups()) + " of their " + grouped(source.list_rows->size()) +
                         " lists, reordered");
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
  for (std::size_t i = 0; i < std::min<std::size_t>(source.column_names.size(), most_names); ++i) {
    line("", "source column " + std::to_string(i) + ": " + source.column_names[i]);
  }
  if (!source.column_levels.empty()) {
    std::set<std::uint32_t> objects;
    std::uint32_t coarsest = 0;
    for (const auto& [object, level] : source.column_levels) {
      objects.insert(object);
      coarsest = std::max(coarsest, level);
    }
    line("columns are", "levels of detail of " + grouped(objects.size()) + " objects, the coarsest level " +
                            std::to_string(coarsest));
  }
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
  line("objects", grouped(file.scene.object_count) + (file.scene.object_names.empty() ? "" : ", with names"));
  for (std::size_t i = 0; i < std::min<std::size_t>(file.scene.object_names.size(), most_names); ++i) {
    line(i == 0 ? "names" : "", std::to_string(i) + " " + file.scene.object_names[i]);
  }
  if (file.scene.object_names.size() > most_names) line("", "...");
  print_extent(file);
  if (file.opacity_unknown) line("see-through", "unknown: every surface of the file is taken as opaque");
  if (!file.scene.see_through.empty()) {
    line("see-through", grouped(see_through_objects(file.scene)) + " objects");
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
        std::pair(S::boundaries, "boundaries"), std::pair(S::list_rows, "list rows"),
        std::pair(S::row_tree, "row tree"), std::pair(S::tree, "column tree"),
        std::pair(S::row_names, "row names"), std::pair(S::column_names, "column names"),
        std::pair(S::column_levels, "levels")}) {
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
  if (!level.has_visibility) {
    line("visibility",
         "not in the file; 'vismat scene' takes the triangles, and 'vismat see' computes what is visible");
  }
  for (const std::string& note : level.notes) line("visibility", note);
  if (level.has_visibility && level.notes.empty()) line("visibility", "in the file");
  if (level.has_visibility) print_size(level.cells.shape(), level.cells.ones());
  line((level.cells_are + "s").c_str(), grouped(level.cells.shape().rows));
  line("faces", level.face_ids.empty() ? "none" : grouped(level.face_ids.size()));
  if (!level.face_ids.empty()) {
    line("triangles", grouped(level.face_scene.object_of_triangle.size()));
    line("see-through", grouped(see_through_objects(level.face_scene)) + " faces");
  }
  for (const std::string& what : left_out_of_faces(level)) line("", what);
}

bool is_regular(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

void print_levels(const std::vector<LevelListing>& levels) {
  line("levels", std::to_string(levels.size()));
  for (const LevelListing& level : levels) {
    std::printf("%16s bytes  %s\n", grouped(level.bytes).c_str(), printable(level.where).c_str());
  }
}

// A path, FILE.pk3:MEMBER, or FILE.h5:GROUP.
void print_info(const std::string& where) {
  constexpr LevelNeeds all_that_is_there{.visibility = false, .see_through = false};
  const auto title = [&](const std::string& kind) { line("file", where + " (" + kind + ")"); };
  const MatrixFile file = open_matrix_file(where);
  const std::string_view begin(reinterpret_cast<const char*>(file.bytes.data()),
                               std::min<std::size_t>(file.bytes.size(), 8));
  const std::string format(format_of(file));
  const auto need_plain = [&] {
    if (file.gzipped) throw FormatError(where + ": is gzipped; unpack it with gunzip first");
    if (!is_regular(file.path)) throw FormatError(where + ": is not a regular file; a level must be one");
  };
  if (format.empty() && mesh_format(where)) {
    const AnyScene mesh = read_any_scene(where);
    title(file.gzipped ? "mesh, gzipped" : "mesh");
    print_scene(mesh.file);
    print_notes(mesh);
  } else if (format.empty() && !file.part.empty()) {
    const Level level = read_level(where, all_that_is_there);
    title("level");
    print_level(level);
  } else if (format.empty() &&
             (begin.starts_with("PK") || begin.starts_with("IWAD") || begin.starts_with("PWAD"))) {
    need_plain();
    const auto levels = list_levels(where);
    title("levels");
    print_levels(levels);
  } else if (format.empty() && (begin.starts_with("IBSP") || names_level(where))) {
    need_plain();
    const Level level = read_level(where, all_that_is_there);
    title("level");
    print_level(level);
  } else if (vmat::begins_vmat(file.bytes)) {
    const Container container = naming(where, [&] { return read_container(file.bytes); });
    title("compressed matrix");
    print_container(container, file.bytes);
  } else if (file.is_hdf5 && file.part.empty() &&
             naming(where, [&] { return Hdf5File::open(where).contains("/scene"); })) {
    const SceneFile scene = read_scene(where);
    title("scene");
    print_scene(scene);
  } else {
    MatrixNotes notes;
    Dataset dataset;
    try {
      dataset = read_dataset(file, &notes);
    } catch (const FormatError& error) {
      if (!format.empty()) throw;
      throw FormatError(std::string(error.what()) +
                        "; 'vismat info' also tells of .vmat, .scene.h5, .obj, .ply, .off, .stl, .bsp, .pk3, "
                        ".zip and .wad files");
    }
    title("matrix, " + format + (file.gzipped ? ", gzipped" : ""));
    print_dataset(dataset);
    if (const std::string text = notes.text(); !text.empty()) line("notes", text);
  }
}

}  // namespace

void add_info(Program& program) {
  const auto file = std::make_shared<std::string>();
  const Verb verb = program.verb(
      "info", "Print what a file holds: a matrix, a compressed matrix, a scene, a mesh or levels");
  verb.input("FILE", *file,
             "The file (.bsp.h5, .mtx, .npy, .npz, .vmat, .scene.h5, .obj, .ply, .off, .stl, .bsp, .pk3, "
             ".zip, .wad), or a part of one: "
             "FILE:MAP of levels, FILE.h5:GROUP, FILE.npy:COLUMNS of packed bits")
      .required();
  verb.example("vismat info koth1.bsp.h5");
  verb.example("vismat info pak6-patch085.pk3      (lists its levels)");
  verb.runs([file] { print_info(*file); });
}

}  // namespace vismat::cli
