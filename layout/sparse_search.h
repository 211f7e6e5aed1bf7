// Local search on tours of sparse points, by 2-opt and Or-opt on neighbour lists.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/column_points.h"
#include "layout/sketch.h"
#include "layout/sparse_points.h"

namespace vismat {

struct LocalMoves {
  bool or_opt = true;  // beside 2-opt
  /// No move turns a way of more points than this around.
  std::uint32_t longest_flip = 25000;
};

/// Improves a closed tour of all points, the zero point among them, until no move over the lists' edges
/// shortens it. `lists` holds points.size() points' neighbours, nearest first; a distance of 0xffffffff ends
/// a list. Never lengthens. Deterministic; one thread.
std::vector<std::uint32_t> improve_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                        const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                        const LocalMoves& moves = {});

}  // namespace vismat
