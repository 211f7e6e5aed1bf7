// What the programs about loss share: a merge that is proven to hide nothing, put in order, and coded.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/baselines/program_codecs.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/sections.h"
#include "layout/best_order.h"
#include "layout/groups/grouping.h"
#include "layout/orders/greedy_order.h"
#include "matrix/base/atomic_file.h"
#include "matrix/files/dataset_file.h"
#include "matrix/loss.h"
#include "programs/measuring.h"
#include "programs/prepared_for.h"

namespace vismat::bench {

/// The matrix of a file and, where its columns are nodes, their tree: what a merge here takes along.
inline Dataset read_matrix(const std::filesystem::path& file) {
  Dataset data = read_dataset(file), bare;
  if (!data.source.boundaries.empty())
    throw std::invalid_argument(file.string() + ": holds differences, not cells");
  bare.matrix = std::move(data.matrix);
  if (data.source.columns_are_nodes) {
    bare.source.tree = std::move(data.source.tree);
    bare.source.columns_are_nodes = true;
  }
  return bare;
}

/// `lost` and the share that one cell may lose, of the zeros that there are.
inline GroupingOptions options_of(const VisibilityMatrix& matrix, double lost, double lost_in_row = 1,
                                  std::uint64_t seed = 1) {
  const Shape shape = matrix.shape();
  const double hidden = static_cast<double>(std::uint64_t{shape.rows} * shape.columns - matrix.ones());
  GroupingOptions options;
  options.lost = static_cast<std::uint64_t>(lost * hidden);
  options.lost_in_row = lost_in_row;
  options.seed = seed;
  return options;
}

struct Merge {
  Dataset data;  // as merged and then ordered
  Loss loss;     // nothing missing
  double merge_s = 0, order_s = 0;
  std::uint64_t names_bytes = 0;  // to say which row and column stands for each of the source's

  /// What a cell loses of its own zeros, of the cell that loses more than `share` of all cells.
  double lost_at(double share) const {
    std::vector<double> lost;
    for (std::uint32_t r = 0; r < loss.shape.rows; ++r) lost.push_back(loss.lost_in(r));
    std::sort(lost.begin(), lost.end());
    return lost.empty() ? 0 : lost[static_cast<std::size_t>(share * static_cast<double>(lost.size() - 1))];
  }
};

inline Loss proven(Loss loss) {
  if (loss.missing > 0) {
    throw std::runtime_error("hides a visible entry: row " + std::to_string(loss.first_missing->row) +
                             ", column " + std::to_string(loss.first_missing->column));
  }
  return loss;
}

enum class Ordered { no, yes };

/// Nodes: rows in the greedy order, as paper 002 has it. Else rows and columns in the best order. Names: the groups as a .vmat
/// file has them, which tell of the order too; of a side that is not merged log2 n! bits.
inline void put_in_order(Merge& merge, Ordered ordered) {
  const double start = wall_seconds();
  const VisibilityMatrix& matrix = merge.data.matrix;
  const auto [rows, columns] = matrix.shape();
  const bool nodes = merge.data.source.columns_are_nodes;
  Permutation by_rows = Permutation::identity(rows), by_columns = Permutation::identity(columns);
  if (ordered == Ordered::yes) {
    by_rows = nodes ? order_rows_greedily(matrix) : best_order(transpose(matrix));
    if (!nodes) by_columns = best_order(matrix);
  }
  merge.data = reordered(std::move(merge.data), by_rows, by_columns);
  merge.order_s = wall_seconds() - start;
  const auto names = [](const std::optional<Partition>& groups, const Permutation& order) -> std::uint64_t {
    if (groups) return group_size(groups);
    return order.is_identity() ? 0 : permutation_bytes(order.size());
  };
  merge.names_bytes =
      names(merge.data.source.row_groups, by_rows) + names(merge.data.source.column_groups, by_columns);
}

/// The original as it is, ordered alone.
inline Merge without_merge(const Dataset& original, Ordered ordered = Ordered::yes) {
  Merge merge;
  merge.data = original;
  merge.loss = loss_of(original.matrix, original.matrix);
  put_in_order(merge, ordered);
  return merge;
}

inline Merge merge_of(const Dataset& original, MergeSide side, const Grouping& grouping,
                      const GroupingOptions& options, Ordered ordered = Ordered::yes) {
  Merge merge;
  const double start = wall_seconds();
  const MergeGroups groups = group_sides(original.matrix, side, grouping, options);
  merge.data = merged(original, groups.rows, groups.columns);
  merge.merge_s = wall_seconds() - start;
  merge.loss = proven(loss_of(in_source_numbers(merge.data).matrix, original.matrix));
  put_in_order(merge, ordered);
  return merge;
}

struct Code {
  std::uint64_t bytes =
      0;  // payload, and the index of codecs that give rows alone; as in their papers' tables
  double average_run = 0;  // of codecs that code lengths over a tree; otherwise 0
};

/// Written as a .vmat file, read again and compared with the original, row by row.
inline Code code_of(const Codec& codec, const Merge& merge, const VisibilityMatrix& original) {
  const Container read = read_container(write_container(compress(merge.data, codec)));
  Dataset back;
  back.matrix = decompress(read, codec);
  back.source = read.source;
  const Loss loss = proven(loss_of(in_source_numbers(std::move(back)).matrix, original));
  if (loss.added != merge.loss.added)
    throw std::runtime_error(std::string(codec.name) + " adds to what was merged");
  Code code;
  code.bytes = read.encoded.payload.size();
  if (codec.rows_alone()) code.bytes += read.encoded.index.size();
  const LengthStatistics lengths =
      length_statistics(codec, merge.data.matrix, tree_for(codec, merge.data.source));
  if (lengths.lengths > 0)
    code.average_run = static_cast<double>(lengths.bits) / static_cast<double>(lengths.lengths);
  return code;
}

/// Those of the names that there are here: programs may be missing.
inline std::vector<Codec> codecs_here(const std::vector<std::string>& names) {
  std::vector<Codec> codecs;
  const std::vector<Codec> available = available_program_codecs();
  for (const std::string& name : names) {
    if (codec_named(name, program_codecs()) == nullptr)
      codecs.push_back(find_codec(name));
    else if (const Codec* program = codec_named(name, available))
      codecs.push_back(*program);
  }
  return codecs;
}

constexpr std::pair<std::string_view, MergeSide> merge_sides[] = {
    {"cells", MergeSide::rows}, {"objects", MergeSide::columns}, {"both", MergeSide::both}};

inline MergeSide merge_side(std::string_view name) {
  for (const auto& [known, side] : merge_sides) {
    if (known == name) return side;
  }
  throw std::invalid_argument("'" + std::string(name) + "' is none of cells, objects and both");
}

}  // namespace vismat::bench
