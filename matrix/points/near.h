// The near points of each point, at any number of points: what merging, trees, differences between nearest rows and
// codecs with reference rows look for.
#pragma once
#include <cstdint>

#include "matrix/base/parallel.h"
#include "matrix/points/column_points.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

struct NearOptions {
  std::uint32_t neighbours = 10;  // of each point
  /// The zero point has a list and is in lists like any other, as in exact_neighbours; its number is the last.
  bool zero = false;
  /// What a one of a point counts that the other lacks, against 1 for one of the other's that the point lacks. 1: the
  /// distance is the symmetric difference. More suits those who tell a point by what another has.
  std::uint32_t lacked = 1;
  /// All pairs are compared if that is estimated to take no more processor time than this; otherwise candidates are
  /// found with sketches. The estimate depends on the points' sizes alone, never on the machine.
  double exact_seconds = 120;
  std::uint64_t seed = 1;  // of the sketches' candidates
  Stages stages = {};
};

/// For each point, the zero point only if asked for, its nearest other ones, nearest first, ties by number.
struct NearPoints {
  /// per_point is the number asked for, or less if there are fewer other points. All distances are exact. A list that
  /// found fewer (never if `exact`) ends with id no_point and distance no_point.
  NeighbourLists lists;
  /// The lists are those of a comparison of all pairs. Otherwise near points may be missing: matrix/points/sketch.cpp
  /// has the measured share.
  bool exact = true;
};

/// The points are a matrix's columns, equal ones once; for rows, make SparsePoints of the transposed matrix. The same
/// points and options give the same lists with any number of threads. Time: up to exact_seconds, one addition for each
/// two ones of two points in the same row, or columns^2 * rows / 64 word operations, whichever is less; beyond, nearly
/// linear in the ones. Memory: the points' ones once more (4 bytes each) or as bits, 8 bytes for each neighbour and 4
/// for each point and thread; with sketches, about 200 bytes and the sketch of each point.
NearPoints near_points(const SparsePoints& points, const NearOptions& options = {}, unsigned threads = 0);

}  // namespace vismat
