// What the verbs about loss share: a merge that is proven to hide nothing, put in order, and coded.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "codecs/codec.h"
#include "layout/groups/grouping.h"
#include "matrix/dataset.h"
#include "matrix/loss.h"

namespace vismat::bench {

/// The matrix of a file and, where its columns are nodes, their tree: what a merge here takes along.
Dataset read_matrix(const std::filesystem::path& file);

/// `lost` and the share that one cell may lose, of the zeros that there are.
GroupingOptions options_of(const VisibilityMatrix& matrix, double lost, double lost_in_row = 1,
                           std::uint64_t seed = 1);

struct Merge {
  Dataset data;  // as merged and then ordered
  Loss loss;     // nothing missing
  double merge_s = 0, order_s = 0;
  std::uint64_t names_bytes = 0;  // maps: which row and column stands for each of the source's

  /// What a cell loses of its own zeros, of the cell that loses more than `share` of all cells.
  double lost_at(double share) const;
};

/// The same loss. Throws std::runtime_error where a visible entry is missing.
Loss proven(Loss loss);

enum class Ordered { no, yes };

/// The source without loss, put in order: over nodes the rows in the greedy order of Zach & Karner 2003, else rows and columns in
/// the best order. The maps take the bytes that the groups of a merged side, which include its order, take in a .vmat file, and
/// log2 n! bits for the order of any other side.
Merge without_merge(const Dataset& original, Ordered ordered = Ordered::yes);

/// Merged, and then ordered as without_merge does.
Merge merge_of(const Dataset& original, MergeSide side, const Grouping& grouping,
               const GroupingOptions& options, Ordered ordered = Ordered::yes);

struct Code {
  std::uint64_t bytes =
      0;  // payload, and the index of codecs that give rows alone; as in their papers' tables
  double average_run = 0;  // of codecs that code lengths over a tree; otherwise 0
};

/// Written as a .vmat file, read again and compared with the source, row by row.
Code code_of(const Codec& codec, const Merge& merge, const VisibilityMatrix& original);

/// Those of the named codecs that this machine has: programs may be missing.
std::vector<Codec> codecs_here(const std::vector<std::string>& names);

/// "cells", "objects" or "both".
MergeSide merge_side(std::string_view name);

}  // namespace vismat::bench
