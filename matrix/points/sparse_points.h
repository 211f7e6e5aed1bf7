// The distinct columns of a matrix as sparse points of a Hamming space, for matrices too large for ColumnPoints.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "matrix/base/scratch_ids.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Equal columns become one point and empty columns none: an order loses nothing by keeping them together. A
/// constructor argument keeps all columns; then point c is column c. Point size() is the zero point, the all-zero
/// vector, as in ColumnPoints. Memory: the matrix once more, transposed, and 12 bytes for each column. O(ones) to
/// construct.
class SparsePoints {
 public:
  explicit SparsePoints(const VisibilityMatrix& matrix, bool collapse = true);
  /// The rows of a matrix as points, each of them; empty and equal ones too.
  static SparsePoints of_rows(VisibilityMatrix rows);
  /// Keeps the ones in a temporary file in `folder`, written through a buffer of about `buffer_bytes` with one scan of
  /// the matrix for each buffer full. Throws std::runtime_error if there is no room.
  SparsePoints(const VisibilityMatrix& matrix, const std::filesystem::path& folder,
               std::uint64_t buffer_bytes);

  std::uint32_t size() const { return static_cast<std::uint32_t>(column_of_point_.size()); }
  std::uint32_t rows() const { return shape_.rows; }
  std::uint32_t zero() const { return size(); }
  /// The ones of a point, ascending.
  std::span<const std::uint32_t> ones(std::uint32_t point) const {
    if (point == zero()) return {};
    return of_column(column_of_point_[point]);
  }
  std::uint32_t weight(std::uint32_t point) const { return static_cast<std::uint32_t>(ones(point).size()); }
  /// Merges the two lists: O(weight(a) + weight(b)).
  std::uint32_t distance(std::uint32_t a, std::uint32_t b) const;
  /// The first column equal to a point.
  std::uint32_t column(std::uint32_t point) const { return column_of_point_[point]; }
  /// Turns a visiting order of all points except zero() into an order of all columns; empty columns come last.
  Permutation order_of_columns(std::span<const std::uint32_t> points) const;
  /// The points in the order in which an order of all columns reaches the first column of each.
  std::vector<std::uint32_t> visits_of_order(const Permutation& order) const;

 private:
  SparsePoints(Shape shape, VisibilityMatrix transposed);  // keeps all columns
  void find_points();
  std::span<const std::uint32_t> of_column(std::uint32_t column) const {
    if (offsets_.empty()) return in_memory_.row(column);
    return on_disk_.ids().subspan(offsets_[column], offsets_[column + 1] - offsets_[column]);
  }
  Shape shape_;
  VisibilityMatrix in_memory_;  // the transposed matrix, or otherwise
  ScratchIds on_disk_;          // its ids
  std::vector<std::uint64_t> offsets_;
  std::vector<std::uint32_t> column_of_point_;
  std::vector<std::uint32_t> twin_;  // for each column the next one equal to it, or `none`
  std::vector<std::uint32_t> empty_;
};

/// The runs of the matrix when its points are visited in this order: half the length of the tour from zero() and back
/// to it.
std::uint64_t runs_of_visits(const SparsePoints& points, std::span<const std::uint32_t> visits,
                             unsigned threads = 0);

/// The distance of a point of weight `of` from one of weight `from`, which differ in `difference` ones or, if that is a
/// lower bound, in no fewer: a one that the other lacks counts `lacked`, one that only the other has counts 1.
inline std::uint32_t distance_with(std::uint32_t lacked, std::uint32_t difference, std::uint32_t of,
                                   std::uint32_t from) {
  const std::uint32_t twice = difference + of > from ? difference + of - from : 0;
  return difference + (lacked - 1) * (twice / 2);
}

}  // namespace vismat
