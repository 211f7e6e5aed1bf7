// Searches for clusters: in each round it finds subsets that several lists have in common, and replaces them by a cluster where
// that makes the coded size smaller.
#pragma once
#include <cstdint>
#include <functional>

#include "codecs/clusters/panne_table.h"
#include "matrix/base/parallel.h"

namespace vismat {

struct PanneSearch {
  /// 0: until rounds save little, with the same result on any machine. Otherwise the search goes on for that long.
  double seconds = 0;
  std::uint64_t seed = 1;
  unsigned threads = 0;  // 0: one for each core
  /// In milliseconds if seconds are given, otherwise in rounds, whose number is estimated.
  Progress progress = {};
  /// Called after each round with the table as it is then. Its time does not count towards the seconds.
  std::function<void(const PanneTable&)> after_round = {};
  /// Called after each step that changed the table. For tests.
  std::function<void(const PanneTable&)> after_step = {};
};

/// A table of the matrix in which each step of the search saved something; when the seconds are over, the table as it
/// is then. Without `seconds` the same seed gives the same table with any number of threads, after some 20 to 100
/// rounds of O(ones) at most.
PanneTable search_clusters(const VisibilityMatrix& matrix, const PanneSearch& search);

}  // namespace vismat
