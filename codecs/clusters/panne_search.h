// The search for clusters: which lists share, which symbols join (panne_table.h), one round after another.
#pragma once
#include <cstdint>
#include <functional>

#include "codecs/clusters/panne_table.h"
#include "matrix/base/parallel.h"

namespace vismat {

struct PanneSearch {
  /// 0: until rounds save little, the same on any machine; else as long as this.
  double seconds = 0;
  std::uint64_t seed = 1;
  unsigned threads = 0;  // 0: one a core
  /// In milliseconds where seconds are given, else in rounds of an estimate.
  Progress progress = {};
  /// Called after each round, with the table as it is then; its time counts as no part of the seconds.
  std::function<void(const PanneTable&)> after_round = {};
  /// Called after each step that changed the table. For tests.
  std::function<void(const PanneTable&)> after_step = {};
};

/// A table of the matrix, each step of which saved something; when time is over, what there is then. Without `seconds` the
/// same for the same seed, for any thread count, after some 20 to 100 rounds of O(ones) at most.
PanneTable search_clusters(const VisibilityMatrix& matrix, const PanneSearch& search);

}  // namespace vismat
