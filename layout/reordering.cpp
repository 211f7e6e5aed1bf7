#include "layout/reordering.h"

#include <array>
#include <stdexcept>
#include <string>

#include "layout/bisection.h"
#include "layout/cost.h"
#include "layout/distinct_columns.h"
#include "layout/greedy_order.h"
#include "layout/sampled_tour.h"
#include "layout/simple_orders.h"
#include "layout/sparse_tour.h"
#include "layout/tour.h"

namespace vismat {
namespace {

constexpr std::uint32_t candidates = 10;  // neighbours a point; 8 to 12 polish alike

Permutation polished(const VisibilityMatrix& matrix, const ReorderingOptions& options) {
  const ColumnPoints points(matrix);
  const NeighbourLists lists = exact_neighbours(points, candidates, options.threads);
  return order_of_tour(polish(points, lists, greedy_edge_tour(points, lists),
                              {.kicks_per_point = options.seconds > 0 ? 1e9 : 20.,
                               .seed = options.seed,
                               .seconds = options.seconds}));
}

Permutation at_scale(const VisibilityMatrix& matrix, const ReorderingOptions& options) {
  ScaleOptions scale;
  scale.nearby.seed = options.seed;
  return order_at_scale(matrix, scale, options.threads);
}

// All pairs of 20000 columns take seconds; of 400000 they would take hours.
constexpr std::uint32_t most_pairs_columns = 20000;

Permutation best(const VisibilityMatrix& matrix, const ReorderingOptions& options) {
  const DistinctColumns distinct = distinct_columns(matrix);
  const bool small = distinct.matrix.shape().columns <= most_pairs_columns;
  const Permutation of_distinct =
      small ? polished(distinct.matrix, options) : at_scale(distinct.matrix, options);
  const Permutation order = unfold(of_distinct, distinct.distinct_of_column);
  const Permutation rows = Permutation::identity(matrix.shape().rows);
  if (count_runs(permute(matrix, rows, order)) <= count_runs(matrix)) return order;
  return Permutation::identity(matrix.shape().columns);
}

constexpr std::array<Reordering, 11> table = {{
    {"identity", "as they stand",
     [](const VisibilityMatrix& m, const ReorderingOptions&) {
       return Permutation::identity(m.shape().columns);
     }},
    {"random", "what the papers measure against",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return random_order(m.shape().columns, o.seed);
     }},
    {"lexicographic", "sorted as bit strings",
     [](const VisibilityMatrix& m, const ReorderingOptions&) { return lexicographic_order(m); }},
    {"morton", "a Z-order curve through the boxes' centres",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       if (o.column_bounds.size() != m.shape().columns)
         throw std::invalid_argument("morton needs a box for each column, which this matrix lacks");
       return morton_order(o.column_bounds);
     }},
    {"greedy", "always the most similar next [Zach & Karner 2003]",
     [](const VisibilityMatrix& m, const ReorderingOptions&) { return order_rows_greedily(transpose(m)); }},
    {"exact-tour", "nearest unvisited neighbour from the zero point on",
     [](const VisibilityMatrix& m, const ReorderingOptions&) {
       return order_of_tour(nearest_neighbour_tour(ColumnPoints(m)));
     }},
    {"sampled-tour", "nearest of a sample, then edge flips [Chhugani et al. 2005]",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return order_by_sampled_tour(m, {.seed = o.seed}, o.threads);
     }},
    {"scale-tour", "greedy edges among columns found by min-hash, 2-opt, Or-opt: for 10^5 columns", at_scale},
    {"bisection", "recursive graph bisection [Dhulipala et al. 2016]",
     [](const VisibilityMatrix& m, const ReorderingOptions&) { return order_by_bisection(m); }},
    {"polished-tour", "greedy edge, 2-opt, Or-opt, local double bridges", polished},
    {"best", "equal columns collapsed, polished tour, never worse than identity", best},
}};

}  // namespace

std::span<const Reordering> reorderings() {
  return table;
}

const Reordering& find_reordering(std::string_view name) {
  std::string names;
  for (const Reordering& method : table) {
    if (method.name == name) return method;
    names += (names.empty() ? "" : ", ") + std::string(method.name);
  }
  throw std::invalid_argument("no order '" + std::string(name) + "'; there are " + names);
}

}  // namespace vismat
