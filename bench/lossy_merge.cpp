#include "bench/lossy_merge.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/baselines/program_codecs.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/sections.h"
#include "layout/best_order.h"
#include "layout/orders/greedy_order.h"
#include "matrix/files/dataset_file.h"
#include "programs/measuring.h"
#include "programs/prepared_for.h"

namespace vismat::bench {
namespace {

void put_in_order(Merge& merge, Ordered ordered) {
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

}  // namespace

Dataset read_matrix(const std::filesystem::path& file) {
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

GroupingOptions options_of(const VisibilityMatrix& matrix, double lost, double lost_in_row,
                           std::uint64_t seed) {
  const Shape shape = matrix.shape();
  const double hidden = static_cast<double>(std::uint64_t{shape.rows} * shape.columns - matrix.ones());
  GroupingOptions options;
  options.lost = static_cast<std::uint64_t>(lost * hidden);
  options.lost_in_row = lost_in_row;
  options.seed = seed;
  return options;
}

double Merge::lost_at(double share) const {
  std::vector<double> lost;
  for (std::uint32_t r = 0; r < loss.shape.rows; ++r) lost.push_back(loss.lost_in(r));
  return quantile(std::move(lost), share);
}

Loss proven(Loss loss) {
  if (loss.missing > 0) {
    throw std::runtime_error("hides a visible entry: row " + std::to_string(loss.first_missing->row) +
                             ", column " + std::to_string(loss.first_missing->column));
  }
  return loss;
}

Merge without_merge(const Dataset& original, Ordered ordered) {
  Merge merge;
  merge.data = original;
  merge.loss = loss_of(original.matrix, original.matrix);
  put_in_order(merge, ordered);
  return merge;
}

Merge merge_of(const Dataset& original, MergeSide side, const Grouping& grouping,
               const GroupingOptions& options, Ordered ordered) {
  Merge merge;
  const double start = wall_seconds();
  const MergeGroups groups = group_sides(original.matrix, side, grouping, options);
  merge.data = merged(original, groups.rows, groups.columns);
  merge.merge_s = wall_seconds() - start;
  merge.loss = proven(loss_of(in_source_numbers(merge.data).matrix, original.matrix));
  put_in_order(merge, ordered);
  return merge;
}

Code code_of(const Codec& codec, const Merge& merge, const VisibilityMatrix& original) {
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

std::vector<Codec> codecs_here(const std::vector<std::string>& names) {
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

MergeSide merge_side(std::string_view name) {
  if (name == "cells") return MergeSide::rows;
  if (name == "objects") return MergeSide::columns;
  if (name == "both") return MergeSide::both;
  throw std::invalid_argument("'" + std::string(name) + "' is none of cells, objects and both");
}

}  // namespace vismat::bench
