// vismat tree: a tree over a matrix's columns or rows, by their boxes or by the rows' sets.
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "cli/verbs.h"
#include "layout/trees/set_tree.h"
#include "matrix/files/dataset_file.h"
#include "programs/progress.h"
#include "visibility/geometry/bounding_volume_tree.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string input, output, side = "columns", by = "boxes";
  unsigned arity = 4;
  bool nodes = false;
};

ObjectTree tree_over_columns(const Dataset& dataset, const Arguments& arguments) {
  if (dataset.source.columns_are_nodes) {
    throw std::invalid_argument(arguments.input + ": its columns are the nodes of a tree already");
  }
  if (arguments.by == "sets") throw std::invalid_argument("--by sets makes trees over rows; add --side rows");
  if (dataset.column_bounds.empty()) {
    throw std::invalid_argument(arguments.input + ": its columns have no boxes to build a tree from");
  }
  return bounding_volume_tree(dataset.column_bounds, arguments.arity);
}

ObjectTree tree_over_rows(const Dataset& dataset, const Arguments& arguments) {
  if (!dataset.source.boundaries.empty()) {
    throw std::invalid_argument(arguments.input +
                                ": holds differences; a tree over rows is one over view cells, which "
                                "'vismat deltas --undo' makes of them");
  }
  if (arguments.nodes)
    throw std::invalid_argument("--nodes makes columns of a tree's nodes; it goes with --side columns");
  if (arguments.by == "sets") {
    if (arguments.arity != 2) throw std::invalid_argument("--by sets makes binary trees; leave out --arity");
    return tree_by_sets(dataset.matrix, show_progress);
  }
  if (dataset.row_bounds.empty()) {
    throw std::invalid_argument(arguments.input +
                                ": its rows have no boxes to build a tree from; --by sets does without");
  }
  return bounding_volume_tree(dataset.row_bounds, arguments.arity);
}

void run(const Arguments& arguments) {
  Dataset dataset = read_dataset(arguments.input);
  const bool rows = arguments.side == "rows";
  auto& tree = rows ? dataset.source.row_tree : dataset.source.tree;
  tree = rows ? tree_over_rows(dataset, arguments) : tree_over_columns(dataset, arguments);
  if (arguments.nodes) dataset = over_nodes(dataset);
  write_dataset(arguments.output, dataset);
  const ObjectTree& made = rows ? *dataset.source.row_tree : *dataset.source.tree;
  std::printf("%s: a tree of %u nodes over %u %s\n", arguments.output.c_str(), made.size(),
              made.object_count(), rows ? "rows" : "objects");
}

}  // namespace

void add_tree(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand("tree", "Build a tree over a matrix's columns or rows");
  verb->footer(
      "The tree replaces what the file had on that side. Trees over columns are for the codecs zach..., "
      "binary ones over "
      "rows for gotsman...\n"
      "Example: vismat tree koth1.bsp.h5 -o koth1.nodes.bsp.h5 --nodes\n"
      "Example: vismat tree koth1.bsp.h5 -o koth1.rows.bsp.h5 --side rows --by sets");
  verb->add_option("IN", arguments->input, "A matrix file")->required();
  verb->add_option("-o,--output", arguments->output, "The matrix file to write (.bsp.h5)")->required();
  verb->add_option("--side", arguments->side, "What the tree stands over: columns or rows")
      ->check(CLI::IsMember({"columns", "rows"}))
      ->capture_default_str();
  verb->add_option("--by", arguments->by,
                   "boxes: median splits of their centres; sets: rows that see the same together")
      ->check(CLI::IsMember({"boxes", "sets"}))
      ->capture_default_str();
  CLI::Option* arity =
      verb->add_option("--arity", arguments->arity, "Most children a node has; default: 4, over rows 2")
          ->check(CLI::Range(2u, 1000000u));
  verb->add_flag("--nodes", arguments->nodes, "Make the tree's nodes the columns");
  verb->callback([arguments, arity] {
    if (arity->count() == 0 && arguments->side == "rows") arguments->arity = 2;
    run(*arguments);
  });
}

}  // namespace vismat::cli
