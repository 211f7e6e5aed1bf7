// Matrices that every codec and order is tried on.
#pragma once
#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "codecs/codec.h"
#include "matrix/base/random.h"
#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"
#include "tests/sanitized.h"

namespace vismat {

/// GoogleTest's name for a codec as a test's parameter.
inline void PrintTo(const Codec& codec, std::ostream* out) {
  *out << codec.name;
}

}  // namespace vismat

namespace vismat::test {

inline VisibilityMatrix random_matrix(Shape shape, double density, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<std::uint32_t>> rows(shape.rows);
  const auto share = static_cast<float>(density);
  for (auto& row : rows) {
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (random.unit() < share) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

/// Column c, standing at place c * step % columns, sees rows c to c + width - 1: in its planted order each row is one run.
inline VisibilityMatrix banded_matrix(std::uint32_t columns, std::uint32_t width, std::uint32_t step) {
  std::vector<std::vector<std::uint32_t>> rows(columns + width - 1);
  for (std::uint32_t c = 0; c < columns; ++c) {
    for (std::uint32_t r = c; r < c + width; ++r) rows[r].push_back(c * step % columns);
  }
  for (auto& row : rows) std::sort(row.begin(), row.end());
  return VisibilityMatrix::from_rows(rows, columns);
}

/// Rows that differ from the one before in a few places, as neighbouring view cells do.
inline VisibilityMatrix clustered_matrix(Shape shape, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<std::uint32_t>> rows(shape.rows);
  std::vector<char> visible(shape.columns);
  for (auto& row : rows) {
    for (std::uint32_t i = 0; i < 1 + shape.columns / 50; ++i) {
      const std::uint32_t from = random.below(shape.columns), length = random.below(8);
      const bool value = random.below(5) < 2;
      for (std::uint32_t c = from; c < shape.columns && c < from + length; ++c) visible[c] = value;
    }
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (visible[c]) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

/// A tree of this many leaves, one for each object, with up to `arity` children for each node.
inline ObjectTree even_tree(std::uint32_t objects, std::uint32_t arity = 4) {
  struct Range {
    std::uint32_t first, end, parent;
  };
  std::vector<Range> queue = {{0, objects, ObjectTree::none}};
  std::vector<std::uint32_t> parents, object_of_node;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Range range = queue[i];
    parents.push_back(range.parent);
    const std::uint32_t count = range.end - range.first;
    object_of_node.push_back(count == 1 ? range.first : ObjectTree::none);
    for (std::uint32_t part = 0; count > 1 && part < arity; ++part) {
      const std::uint32_t first = range.first + count * part / arity,
                          end = range.first + count * (part + 1) / arity;
      if (first < end) queue.push_back({first, end, static_cast<std::uint32_t>(i)});
    }
  }
  return ObjectTree::from_parents(parents, object_of_node, objects);
}

struct NamedMatrix {
  std::string name;
  VisibilityMatrix matrix;
};

/// `little`: of fewer columns, for what takes long for each.
inline std::vector<NamedMatrix> assorted_matrices(bool little = false) {
  std::vector<NamedMatrix> all;
  all.push_back({"empty", VisibilityMatrix(Shape{0, 0})});
  all.push_back({"no rows", VisibilityMatrix(Shape{0, 5})});
  all.push_back({"no columns", VisibilityMatrix(Shape{5, 0})});
  all.push_back({"1x1 zero", VisibilityMatrix(Shape{1, 1})});
  all.push_back({"1x1 one", VisibilityMatrix::from_rows({{0}}, 1)});
  for (const std::uint32_t columns : {7u, 8u, 9u, 63u, 64u, 65u}) {
    all.push_back({std::to_string(columns) + " columns", random_matrix({20, columns}, .3, columns)});
  }
  all.push_back({"all zero", VisibilityMatrix(Shape{70, 300})});
  all.push_back({"all one", random_matrix({70, little ? 100u : 300u}, 2, 1)});
  const Shape wide = little ? Shape{40, 130} : sanitized ? Shape{45, 350} : Shape{60, 400};
  all.push_back({"sparse", random_matrix(wide, .005, 2)});
  all.push_back({"dense", random_matrix(wide, .95, 3)});
  all.push_back({"clustered", clustered_matrix(little      ? Shape{150, 130}
                                               : sanitized ? Shape{150, 200}
                                                           : Shape{260, 300},
                                               4)});
  return all;
}

}  // namespace vismat::test
