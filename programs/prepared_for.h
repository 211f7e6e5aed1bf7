// Prepares a dataset for a codec: node columns, a row tree, orders. The program, benchmarks and tests all use it.
#pragma once
#include <string>

#include "codecs/codec.h"
#include "codecs/vmat/container.h"
#include "matrix/base/parallel.h"
#include "matrix/dataset.h"

namespace vismat {

struct PrepareOptions {
  bool orders = true;  // false: rows and columns stay in the order in which they are
  Stages stages = {};  // progress of what takes long
};

/// Why the dataset cannot be prepared for the codec, and what would help; empty if it can. O(1); O(ones) for
/// differences over a tree's nodes.
std::string obstacle(const Codec& codec, const Dataset& data);

/// The dataset as the codec needs it. Its columns may become a tree's nodes; it may get a binary tree over the rows,
/// made from their boxes if it has none; equal rows and columns may be stored once; and rows and columns may be
/// reordered, which removes boundaries. Its source map says what was done. Throws std::invalid_argument with the
/// obstacle.
Dataset prepared_for(const Codec& codec, Dataset data, const PrepareOptions& options = {});

/// What the codec's reader will know besides the payload. Borrows the dataset.
Side side_of(const Codec& codec, const Dataset& data);

/// The prepared dataset's matrix and source map, compressed.
Container compress(const Dataset& prepared, const Codec& codec, const EncodeOptions& options = {});

}  // namespace vismat
