// Held and Karp's lower bound on the number of runs of any order of columns, for matrices of any size.
#pragma once
#include <cstdint>
#include <span>

#include "layout/bounds/bound.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

struct HeldKarpOptions {
  std::uint32_t rounds = 8;       // of ascent and pricing (below)
  std::uint32_t steps = 50;       // of ascent a round
  std::uint32_t neighbours = 10;  // of each point in the graph that the ascent begins with
  /// If above 0, as many rounds as that allows, or none if not even one is possible. The bound then depends on the
  /// machine's speed.
  double seconds = 0;
  /// If the distances of all pairs take at most this many bytes they are kept; otherwise they are computed anew for
  /// each pricing.
  std::uint64_t pair_bytes = std::uint64_t{2} << 30;
  unsigned threads = 0;
  Stages stages = {};  // none are reported if `seconds` bound the work
};

/// Held & Karp's ascent [Operations Research 1970; Mathematical Programming 1971] over the closed tours through the
/// points and the zero point. `visits` is any order of all points: its length steers the steps and never affects the
/// validity. All computation is in integers, so the bound is exact arithmetic, and the same with any number of threads.
/// The ascent improves the bound step by step; a step is one spanning tree of the candidate graph. A *pricing* checks
/// all pairs of points for edges that the candidate graph lacks. Memory: the pairs, the matrix once more, and 40 bytes
/// for each candidate edge.
LowerBound held_karp_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                           const HeldKarpOptions& options = {});

}  // namespace vismat
