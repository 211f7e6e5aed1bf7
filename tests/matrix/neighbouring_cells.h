// Matrices of view cells with neighbours, for tests of differences.
#pragma once
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/deltas.h"

namespace vismat {

using Rows = std::vector<std::vector<std::uint32_t>>;
inline constexpr std::uint32_t outside = Boundary::outside;

// Some rows are empty, some equal to an earlier one, some like it.
inline VisibilityMatrix random_cells(Shape shape, Random& random) {
  Rows rows(shape.rows);
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    const std::uint32_t kind = random.below(8);
    if (kind == 0) continue;
    std::vector<bool> bits(shape.columns, false);
    if (r > 0 && kind < 6) {
      for (const std::uint32_t c : rows[random.below(r)]) bits[c] = true;
      if (kind > 1 && shape.columns > 0) {
        for (std::uint32_t flips = random.below(9); flips > 0; --flips)
          bits[random.below(shape.columns)].flip();
      }
    } else {
      const float density = random.unit();
      for (std::uint32_t c = 0; c < shape.columns; ++c) bits[c] = random.unit() < density;
    }
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (bits[c]) rows[r].push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

inline VisibilityMatrix symmetric(std::uint32_t size,
                                  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  std::vector<std::set<std::uint32_t>> sets(size);
  for (const auto& [a, b] : pairs) {
    sets[a].insert(b);
    sets[b].insert(a);
  }
  Rows rows;
  for (const auto& set : sets) rows.emplace_back(set.begin(), set.end());
  return VisibilityMatrix::from_rows(rows, size);
}

// Few pairs leave many parts and lone cells; some cells are their own neighbours.
inline VisibilityMatrix random_neighbours(std::uint32_t size, Random& random) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t count = size == 0 ? 0 : random.below(3 * size); count > 0; --count)
    pairs.emplace_back(random.below(size), random.below(size));
  return symmetric(size, pairs);
}

struct Case {
  VisibilityMatrix cells, neighbours;
};
inline std::vector<Case> random_cases() {
  std::vector<Case> cases = {{VisibilityMatrix({0, 0}), VisibilityMatrix({0, 0})},
                             {VisibilityMatrix({0, 7}), VisibilityMatrix({0, 0})},
                             {VisibilityMatrix({5, 0}), symmetric(5, {{0, 1}, {1, 4}})},
                             {VisibilityMatrix({4, 9}), symmetric(4, {{0, 1}, {1, 2}, {2, 3}})}};
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const Shape shape = {1 + random.below(40), random.below(300)};
    cases.push_back({random_cells(shape, random), random_neighbours(shape.rows, random)});
  }
  return cases;
}

}  // namespace vismat
