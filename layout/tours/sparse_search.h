// Local search on tours of sparse points.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/tours/local_search.h"
#include "matrix/points/column_points.h"
#include "matrix/points/sketch.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

/// Improves a closed tour of all points, the zero point among them, until no move over the lists' edges shortens it.
/// `lists` has the neighbours of points.size() points, nearest first; a distance of 0xffffffff ends a list. The tour
/// never gets longer. Deterministic; one thread.
std::vector<std::uint32_t> improve_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                        const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                        const LocalMoves& moves = {});

/// Kicks a local optimum: each window of the tour separately, on several threads; with `seconds`, again and again for
/// that long. The tour never gets longer. Without `seconds` the same seed gives the same tour with any number of threads.
std::vector<std::uint32_t> kick_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                     const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                     const PolishOptions& options, unsigned threads = 0);

}  // namespace vismat
