// vismat merge: merges similar view cells or objects into groups, and expands the groups again.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/vmat/sections.h"
#include "layout/groups/grouping.h"
#include "matrix/loss.h"
#include "programs/options.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

struct MergeOptions {
  std::filesystem::path in, out;
  std::string side = "cells", method = "pairs";
  double lost = 0.05, max_per_cell = 1;
  std::optional<double> added;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool expand = false;
};

void merge(const MergeOptions& options) {
  const Grouping& grouping = find_grouping(options.method);
  if (!keeps_everything(options.out))
    throw std::invalid_argument(options.out.string() + ": has no place for the map; write .bsp.h5");
  Dataset data = read_matrix(options.in);
  if (!data.source.boundaries.empty()) {
    throw std::invalid_argument(
        options.in.string() +
        ": holds differences; merge the view cells, which 'vismat deltas --undo' restores");
  }
  const VisibilityMatrix original = data.matrix;
  const auto [rows, columns] = original.shape();
  const std::uint64_t hidden = std::uint64_t{rows} * columns - original.ones();
  const double budget = options.added ? *options.added * static_cast<double>(original.ones())
                                      : options.lost * static_cast<double>(hidden);
  const MergeSide side = options.side == "cells"     ? MergeSide::rows
                         : options.side == "objects" ? MergeSide::columns
                                                     : MergeSide::both;
  const MergeGroups groups = group_sides(original, side, grouping,
                                         {.lost = static_cast<std::uint64_t>(budget),
                                          .lost_in_row = options.max_per_cell,
                                          .seed = options.seed,
                                          .threads = options.threads,
                                          .progress = show_progress("merging")});
  const bool nodes = data.source.columns_are_nodes;
  data = merged(std::move(data), groups.rows, groups.columns);
  if (!data.provenance.empty()) data.provenance += "; ";
  data.provenance += options.side + " merged by " + options.method +
                     formatted(options.added ? ", %g added at most" : ", %g lost at most",
                               options.added ? *options.added : options.lost);
  if (options.max_per_cell < 1) data.provenance += formatted(", %g of any cell", options.max_per_cell);
  data.provenance += ", seed " + std::to_string(options.seed);
  write_matrix(options.out, data);

  if (groups.rows) line("view cells", grouped(groups.rows->groups()) + " of " + grouped(rows) + " are left");
  if (groups.columns)
    line("objects", grouped(groups.columns->groups()) + " of " + grouped(columns) + " are left");
  const Partition of_rows = groups.rows.value_or(Partition::identity(rows));
  print_loss(groups.columns ? loss_of(expand_columns(data.matrix, *groups.columns), of_rows, original)
                            : loss_of(data.matrix, of_rows, original));
  line("map", grouped(group_size(groups.rows) + group_size(groups.columns)) + " bytes in a .vmat file");
  if (nodes && !data.source.columns_are_nodes) line("tree", "left out, because its nodes were merged");
}

void expand(const MergeOptions& options) {
  Dataset data = read_matrix(options.in);
  if (!data.source.row_groups && !data.source.column_groups)
    throw std::invalid_argument(options.in.string() + ": nothing in it was merged");
  write_matrix(options.out, in_source_numbers(std::move(data)));
}

}  // namespace

void add_merge(Program& program) {
  const auto options = std::make_shared<MergeOptions>();
  const Verb verb =
      program.verb("merge", "Merge similar view cells or objects; everything visible stays visible");
  verb.input("MATRIX", options->in, "The matrix file to read (.bsp.h5, .mtx, .npy or .npz)").required();
  verb.output(
      options->out, Written::matrix,
      "The matrix file to write (.bsp.h5): the unions of the groups, and which group each member is in");
  const Option lost =
      verb.option("--lost", options->lost, "Greatest share of the occlusions (zeros) that may be lost")
          .between(0, 1);
  verb.option("--added", options->added,
              "The same bound as a share of the visible entries (ones): how many may be added")
      .between(0, 1e9)
      .excludes(lost);
  verb.option("--max-per-cell", options->max_per_cell,
              "Greatest share of its own occlusions that any one view cell may lose")
      .between(0, 1);
  verb.option("--side", options->side, "What is merged: view cells, objects or both")
      .one_of({"cells", "objects", "both"});
  std::string methods;
  for (const Grouping& grouping : groupings())
    methods += (methods.empty() ? "" : "; ") + std::string(grouping.name) + ": " + std::string(grouping.idea);
  verb.option("--method", options->method, "How to choose what is merged. " + methods);
  verb.option("--seed", options->seed,
              "Random seed of the method seeds, and of what pairs draws among very many rows");
  verb.threads(options->threads);
  verb.flag("--expand", options->expand,
            "Go back from groups to all view cells and objects, each as its group sees or is seen");
  verb.example("vismat merge city.bsp.h5 --lost 0.05 -o merged.bsp.h5");
  verb.example("vismat verify merged.bsp.h5 city.bsp.h5");
  verb.runs([options] { options->expand ? expand(*options) : merge(*options); });
}

}  // namespace vismat::cli
