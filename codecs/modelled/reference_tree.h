// Plans rows that may stand in any order: as a tree in which each row stands under the one that it is coded by.
#pragma once
#include "codecs/modelled/row_references.h"

namespace vismat {

/// The rows in the tree's order, within the limits; a row's reference is one of its near rows, none, or a row that
/// readers keep. The same for any number of threads.
RowPlan plan_tree(const RowEnds& ends, const NearRows& near, const RowLimits& limits, unsigned threads,
                  const Progress& progress);

}  // namespace vismat
