// What a codec needs of a dataset, done: one place for the program, benchmarks and tests.
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

/// Why the dataset cannot have what the codec needs, and what would help; empty where it can.
/// O(1); O(ones) for differences over a tree's nodes.
std::string obstacle(const Codec& codec, const Dataset& data);

/// The dataset as the codec needs it: columns that are a tree's nodes; a binary tree over the rows, of their boxes where there is
/// none; equal rows and columns once; rows and columns in order, which boundaries cannot follow. What was done is told by its
/// source map. Throws std::invalid_argument with the obstacle.
Dataset prepared_for(const Codec& codec, Dataset data, const PrepareOptions& options = {});

/// What the codec's reader will know beside the payload. Borrows the dataset.
Side side_of(const Codec& codec, const Dataset& data);

/// The prepared dataset's matrix and source map, compressed.
Container compress(const Dataset& prepared, const Codec& codec, const EncodeOptions& options = {});

}  // namespace vismat
