// vismat tree: a bounding-volume tree for a matrix whose columns have boxes.
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "cli/verbs.h"
#include "matrix/dataset.h"
#include "visibility/bounding_volume_tree.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string input, output;
  unsigned arity = 4;
  bool nodes = false;
};

void run(const Arguments& arguments) {
  Dataset dataset = read_dataset(arguments.input);
  if (dataset.columns_are_nodes) {
    throw std::invalid_argument(arguments.input + ": its columns are the nodes of a tree already");
  }
  if (dataset.column_bounds.empty()) {
    throw std::invalid_argument(arguments.input + ": its columns have no boxes to build a tree from");
  }
  dataset.tree = bounding_volume_tree(dataset.column_bounds, arguments.arity);
  if (arguments.nodes) dataset = over_nodes(dataset);
  write_dataset(arguments.output, dataset);
  std::printf("%s: a tree of %u nodes over %u objects\n", arguments.output.c_str(), dataset.tree->size(),
              dataset.tree->object_count());
}

}  // namespace

void add_tree(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand("tree", "Build a bounding-volume tree over a matrix's columns");
  verb->footer(
      "The tree replaces what the file had.\n"
      "Example: vismat tree koth1.bsp.h5 -o koth1.nodes.bsp.h5 --nodes");
  verb->add_option("IN", arguments->input, "A matrix file whose columns have boxes")->required();
  verb->add_option("-o,--output", arguments->output, "The matrix file to write (.bsp.h5)")->required();
  verb->add_option("--arity", arguments->arity, "Most children a node has")
      ->check(CLI::Range(2u, 1000000u))
      ->capture_default_str();
  verb->add_flag("--nodes", arguments->nodes, "Make the tree's nodes the columns");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
