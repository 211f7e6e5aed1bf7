#include "layout/reordering.h"

#include <array>
#include <stdexcept>
#include <string>

#include "layout/best_order.h"
#include "layout/orders/bisection.h"
#include "layout/orders/greedy_order.h"
#include "layout/orders/lexicographic_order.h"
#include "layout/orders/morton_order.h"
#include "layout/orders/random_order.h"
#include "layout/tours/exact_tour.h"
#include "layout/tours/flann_tour.h"
#include "layout/tours/polished_tour.h"
#include "layout/tours/sampled_tour.h"
#include "layout/tours/scale_tour.h"

namespace vismat {
namespace {

constexpr std::array<Reordering, 12> table = {{
    {"identity", "as in the matrix file",
     [](const VisibilityMatrix& m, const ReorderingOptions&) {
       return Permutation::identity(m.shape().columns);
     }},
    {"random", "a random order, as a baseline",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return random_order(m.shape().columns, o.seed);
     }},
    {"lexicographic", "sorted as bit strings",
     [](const VisibilityMatrix& m, const ReorderingOptions&) { return lexicographic_order(m); }},
    {"morton", "along a Z-order curve through the centres of the boxes",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       if (o.column_bounds.size() != m.shape().columns)
         throw std::invalid_argument("morton needs a box for each column, which this matrix lacks");
       return morton_order(o.column_bounds);
     }},
    {"greedy", "the most similar column is always next [Zach & Karner 2003]",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return order_rows_greedily(transpose(m), begin_stage(o.stages, "greedy order"));
     }},
    {"exact-tour",
     "the same from the zero point (an added column without ones); sampled-tour approximates it",
     [](const VisibilityMatrix& m, const ReorderingOptions&) { return order_by_exact_tour(m); }},
    {"sampled-tour",
     "a tour to the nearest of a random sample, improved by edge flips [Chhugani et al. 2005]",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return order_by_sampled_tour(m, {.seed = o.seed, .stages = o.stages}, o.threads);
     }},
    {"flann-tour", "a polished tour among the near columns that FLANN finds, which differ at each call",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return order_by_flann_tour(m, {}, {.kicks_per_point = 20, .seed = o.seed, .seconds = o.seconds},
                                  o.threads);
     }},
    {"scale-tour",
     "for 20,000 columns and more: greedy edges among near columns that min-hash finds, improved by 3-opt "
     "and by moving "
     "random segments",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return order_by_scale_tour(m, {.nearby = {.seed = o.seed, .stages = o.stages}, .seconds = o.seconds},
                                  o.threads);
     }},
    {"bisection", "recursive graph bisection [Dhulipala et al. 2016]",
     [](const VisibilityMatrix& m, const ReorderingOptions&) { return order_by_bisection(m); }},
    {"polished-tour", "greedy edges, improved by 3-opt and by moving random segments",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       PolishedTourOptions options;
       options.polish.seed = o.seed;
       options.polish.seconds = o.seconds;
       options.polish.progress = begin_stage(o.stages, "kicks of the tour");
       return order_by_polished_tour(m, options, o.threads);
     }},
    {"best",
     "recommended: the shorter of two polished tours, or scale-tour for many columns; never worse than "
     "identity",
     [](const VisibilityMatrix& m, const ReorderingOptions& o) {
       return best_order(m, {.seed = o.seed, .seconds = o.seconds, .threads = o.threads, .stages = o.stages});
     }},
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
