// Local search on tours of sparse points.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/points/column_points.h"
#include "layout/points/sketch.h"
#include "layout/points/sparse_points.h"
#include "layout/tours/local_search.h"

namespace vismat {

/// Improves a closed tour of all points, the zero point among them, until no move over the lists' edges
/// shortens it. `lists` holds points.size() points' neighbours, nearest first; a distance of 0xffffffff ends
/// a list. Never lengthens. Deterministic; one thread.
std::vector<std::uint32_t> improve_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                        const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                        const LocalMoves& moves = {});

/// Kicks a local optimum; windows of the tour apart, on several threads. If `seconds` are given, again and again for that
/// long. Never lengthens. Same seed and no `seconds`, same tour, for any thread count.
std::vector<std::uint32_t> kick_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                     const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                     const PolishOptions& options, unsigned threads = 0);

}  // namespace vismat
