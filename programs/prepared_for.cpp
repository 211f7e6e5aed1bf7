#include "programs/prepared_for.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "layout/best_order.h"
#include "layout/orders/greedy_order.h"
#include "visibility/geometry/bounding_volume_tree.h"

namespace vismat {
namespace {

// Equal rows and equal columns once. Nothing is lost by it, so the guarantee stays.
Dataset distinct(Dataset data, bool rows_too, bool columns_too) {
  std::optional<Partition> rows, columns;
  if (rows_too) {
    if (auto groups = equal_rows(data.matrix); groups.groups() < groups.size()) rows = std::move(groups);
  }
  if (columns_too) {
    if (auto groups = equal_rows(transpose(data.matrix)); groups.groups() < groups.size())
      columns = std::move(groups);
  }
  if (!rows && !columns) return data;
  const Guarantee guarantee = data.guarantee;
  data = merged(std::move(data), rows, columns);
  data.guarantee = guarantee;
  return data;
}

}  // namespace

std::string obstacle(const Codec& codec, const Dataset& data) {
  const SourceMap& source = data.source;
  if (codec.needs.tree == TreeOver::columns) {
    if (!source.tree) return "this codec needs a tree over the columns; make one with 'vismat tree'";
    if (!source.boundaries.empty() && source.columns_are_nodes && !is_monotone(data.matrix, *source.tree))
      return "holds differences between sets of nodes, which are not monotone over their tree; encode the "
             "cells";
  }
  if (codec.needs.tree == TreeOver::rows) {
    if (!source.boundaries.empty())
      return "holds differences, which no tree over the view cells has for rows; encode the cells";
    if (!source.row_tree && data.row_bounds.empty())
      return "has no tree over its rows and no boxes to make one from; see 'vismat tree --side rows --by "
             "sets'";
  }
  if (codec.needs.boxes && (data.row_bounds.empty() || data.column_bounds.empty()))
    return "has no boxes of its rows and columns, under which this codec codes";
  return {};
}

Dataset prepared_for(const Codec& codec, Dataset data, const PrepareOptions& options) {
  if (const std::string why = obstacle(codec, data); !why.empty()) throw std::invalid_argument(why);
  const Needs& needs = codec.needs;
  if (needs.tree == TreeOver::columns && !data.source.columns_are_nodes) data = over_nodes(data);
  const bool columns_move =
      !data.source.columns_are_nodes;  // nodes keep the numbers that their tree gives them
  // A given tree over the rows cannot follow rows that are merged; one of boxes is made after.
  const bool rows_merge = needs.tree != TreeOver::rows || !data.row_bounds.empty();
  if (needs.distinct) data = distinct(std::move(data), rows_merge, columns_move);
  if (needs.tree == TreeOver::rows && !data.source.row_tree)
    data.source.row_tree = bounding_volume_tree(data.row_bounds, 2);
  if (!options.orders) return data;

  const auto [rows, columns] = data.matrix.shape();
  Permutation by_rows = Permutation::identity(rows), by_columns = Permutation::identity(columns);
  if (columns_move && (needs.column_order || needs.shared_order))
    by_columns = best_order(data.matrix, {.stages = options.stages});
  if (needs.shared_order && rows == columns && data.source.boundaries.empty())
    by_rows = by_columns;
  else if (needs.row_order)
    by_rows = order_rows_greedily(data.matrix, begin_stage(options.stages, "ordering rows"));
  return reordered(std::move(data), by_rows, by_columns);
}

Side side_of(const Codec& codec, const Dataset& data) {
  return {tree_for(codec, data.source), data.row_bounds, data.column_bounds};
}

Container compress(const Dataset& prepared, const Codec& codec, const EncodeOptions& options) {
  return compress(prepared.matrix, codec, prepared.source, options, side_of(codec, prepared));
}

}  // namespace vismat
