// The visibility matrix, which says what objects (columns) may be seen from what view cells (rows).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace vismat {

class Permutation;

struct Shape {
  std::uint32_t rows = 0, columns = 0;
  bool operator==(const Shape&) const = default;
};

/// A binary matrix. Row r lists, ascending and without repeats, the columns that are visible from view cell r. Stored
/// as compressed sparse rows, with offsets of 64 bits and ids of 32 bits, so 5e8 ones take about 2.1 GB.
class VisibilityMatrix {
 public:
  VisibilityMatrix() = default;
  /// A matrix of this shape without ones.
  explicit VisibilityMatrix(Shape shape);
  /// Takes rows + 1 offsets and the ids between them. Throws std::invalid_argument, naming the row, unless the
  /// offsets ascend from 0 to ids.size() and every row's ids ascend strictly and lie below shape.columns. O(ones).
  static VisibilityMatrix from_csr(Shape shape, std::vector<std::uint64_t> offsets,
                                   std::vector<std::uint32_t> ids);
  /// The same from one vector for each row, ascending and without repeats; the checks are the same.
  static VisibilityMatrix from_rows(const std::vector<std::vector<std::uint32_t>>& rows,
                                    std::uint32_t columns);

  Shape shape() const { return shape_; }
  std::uint64_t ones() const { return ids_.size(); }
  /// Ones divided by rows x columns; 0 if there are no rows or no columns.
  double density() const;
  /// The columns that row r lists. Borrowed: valid while *this lives.
  std::span<const std::uint32_t> row(std::uint32_t r) const {
    return {ids_.data() + offsets_[r], static_cast<std::size_t>(offsets_[r + 1] - offsets_[r])};
  }
  std::span<const std::uint64_t> offsets() const { return offsets_; }  // rows + 1 of them
  std::span<const std::uint32_t> ids() const { return ids_; }
  bool contains(std::uint32_t r, std::uint32_t column) const;  // O(log row length)
  bool operator==(const VisibilityMatrix&) const = default;

 private:
  friend VisibilityMatrix permute(VisibilityMatrix, const Permutation&, const Permutation&);
  Shape shape_;
  std::vector<std::uint64_t> offsets_ = {0};
  std::vector<std::uint32_t> ids_;
};

/// The transposed matrix: column c becomes row c. O(ones + rows + columns).
VisibilityMatrix transpose(const VisibilityMatrix& matrix);

/// The matrix in a new order: row r moves to rows.new_of_old()[r] and column c to columns.new_of_old()[c]. The sizes
/// must match the shape. Works in place if the rows stay and the matrix is moved in.
VisibilityMatrix permute(VisibilityMatrix matrix, const Permutation& rows, const Permutation& columns);

}  // namespace vismat
