// vismat tree: builds a tree over a matrix's columns or rows, by their boxes or by the rows' visible sets.
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "layout/trees/set_tree.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/geometry/bounding_volume_tree.h"

namespace vismat::cli {
namespace {

struct TreeArguments {
  std::string input, output, side = "columns", by = "boxes";
  std::optional<unsigned> arity;
  bool nodes = false;
};

ObjectTree tree_over_columns(const Dataset& dataset, const TreeArguments& arguments) {
  if (dataset.source.columns_are_nodes) {
    throw std::invalid_argument(arguments.input + ": its columns are the nodes of a tree already");
  }
  if (arguments.by == "sets") throw std::invalid_argument("--by sets makes trees over rows; add --side rows");
  if (dataset.column_bounds.empty()) {
    throw std::invalid_argument(arguments.input + ": its columns have no boxes to build a tree from");
  }
  return bounding_volume_tree(dataset.column_bounds, arguments.arity.value_or(4));
}

ObjectTree tree_over_rows(const Dataset& dataset, const TreeArguments& arguments) {
  if (!dataset.source.boundaries.empty()) {
    throw std::invalid_argument(
        arguments.input + ": holds differences; restore the view cells with 'vismat deltas --undo' first");
  }
  if (arguments.nodes)
    throw std::invalid_argument("--nodes makes a tree's nodes the columns, so it needs --side columns");
  if (arguments.by == "sets") {
    if (arguments.arity.value_or(2) != 2)
      throw std::invalid_argument("--by sets makes binary trees; leave out --arity");
    return tree_by_sets(dataset.matrix, show_progress);
  }
  if (dataset.row_bounds.empty()) {
    throw std::invalid_argument(arguments.input +
                                ": its rows have no boxes to build a tree from; --by sets needs none");
  }
  return bounding_volume_tree(dataset.row_bounds, arguments.arity.value_or(2));
}

void run_tree(const TreeArguments& arguments) {
  if (!arguments.nodes && !keeps_everything(arguments.output))
    throw std::invalid_argument(arguments.output + ": has no place for the tree; write .bsp.h5");
  Dataset dataset = read_matrix(arguments.input);
  const bool rows = arguments.side == "rows";
  auto& tree = rows ? dataset.source.row_tree : dataset.source.tree;
  tree = rows ? tree_over_rows(dataset, arguments) : tree_over_columns(dataset, arguments);
  if (arguments.nodes) dataset = over_nodes(dataset);
  write_matrix(arguments.output, dataset);
  const ObjectTree& made = rows ? *dataset.source.row_tree : *dataset.source.tree;
  std::printf("%s: a tree of %u nodes over %u %s\n", arguments.output.c_str(), made.size(),
              made.object_count(), rows ? "rows" : "objects");
}

}  // namespace

void add_tree(Program& program) {
  const auto arguments = std::make_shared<TreeArguments>();
  const Verb verb = program.verb("tree", "Build a tree over a matrix's columns or rows");
  verb.input("IN", arguments->input, "The matrix file to read").required();
  verb.output(arguments->output, Written::matrix, "The matrix file to write (.bsp.h5)");
  verb.option("--side", arguments->side, "What the tree is built over: columns or rows")
      .one_of({"columns", "rows"});
  verb.option("--by", arguments->by,
              "boxes: split at the median of the boxes' centres; sets: join the rows with the most similar "
              "visible sets")
      .one_of({"boxes", "sets"});
  verb.option("--arity", arguments->arity,
              "Greatest number of children of a node (default: 4 over columns, 2 over rows)")
      .between(2, 1000000);
  verb.flag("--nodes", arguments->nodes, "Make the tree's nodes the columns");
  verb.note(
      "The new tree replaces the one that the file had on that side. The zach codecs need a tree over the "
      "columns; the gotsman codecs need a binary tree over the rows.");
  verb.example("vismat tree koth1.bsp.h5 -o koth1.nodes.bsp.h5 --nodes");
  verb.example("vismat tree koth1.bsp.h5 -o koth1.rows.bsp.h5 --side rows --by sets");
  verb.runs([arguments] { run_tree(*arguments); });
}

}  // namespace vismat::cli
