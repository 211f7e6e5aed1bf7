// ALGORITHM. A run end that the reference lacks must be told in full, one too many only costs a decision. So distances
// are not symmetric: 4 for the one, 1 for the other; against the number of columns in which rows differ this saves 6 to
// 8 % of the bytes. Candidates from the nearest by the number of run ends in which rows differ, ranked by that distance,
// instead of by it alone: 1 to 6 % more bytes.
#include "codecs/modelled/row_references.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "codecs/modelled/reference_tree.h"
#include "codecs/modelled/row_forest.h"
#include "matrix/points/near.h"

namespace vismat {
namespace {

// How many near rows to try for each; fewer where each trial takes long.
std::uint32_t candidates_per_row(const RowEnds& ends) {
  return static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(std::uint64_t{6400} * ends.rows() / (1 + ends.count()), 8, 32));
}

NearRows near_rows(const RowEnds& ends, unsigned threads, const Stages& stages) {
  const std::uint32_t count = candidates_per_row(ends);
  const SparsePoints points = SparsePoints::of_rows(ends.as_matrix());
  const NeighbourLists lists = near_points(points,
                                           {.neighbours = count,
                                            .lacked = lacked_end,
                                            .exact_seconds = 1e-7 * static_cast<double>(ends.count()) + 1,
                                            .stages = stages},
                                           threads)
                                   .lists;
  NearRows near(ends.rows());
  for (std::uint32_t r = 0; r < ends.rows(); ++r) {
    for (std::size_t n = r * std::size_t{lists.per_point}; n < (r + std::size_t{1}) * lists.per_point; ++n) {
      const std::uint32_t other = lists.ids[n], distance = lists.distances[n];
      if (other == no_point) break;
      const std::uint32_t lacks = (distance + ends[r].count - ends[other].count) / (1 + lacked_end);
      near[r].push_back({other, distance - (lacked_end - 1) * lacks});
    }
  }
  return near;
}

// References among earlier rows, in the order in which rows stand.
RowPlan plan_in_order(const RowEnds& ends, const NearRows& near, const RowLimits& limits,
                      const Progress& progress) {
  constexpr std::uint64_t new_group = 28 * bit_unit;
  const std::uint32_t rows = ends.rows();
  RowPlan plan;
  plan.order.resize(rows);
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  RowForest forest(ends, *limits.weights);
  // Differences between view cells are much shorter than rows of view cells, and read more often.
  double sum = 0;
  for (std::uint32_t r = 0; r < rows; ++r)
    sum += forest.cost(r, near[r].empty() ? no_row : near[r][0].row).microseconds;
  const double longest = std::min(limits.microseconds, limits.mean_rows * sum / rows);
  std::vector<double> chain(rows);            // the time of a row and of all that it takes
  std::vector<std::uint32_t> parts(rows);     // that it takes
  std::uint32_t first = 0, outside = no_row;  // of the group
  for (std::uint32_t r = 0; r < rows; ++r) {
    if (progress && r % 64 == 0) progress(r, rows);
    struct Choice {
      std::uint64_t units = ~std::uint64_t{0};
      std::uint32_t reference = no_row;
      bool joins = false, raw = false;
      double chain = 0;
      std::uint32_t parts = 1;
    } best;
    const auto offer = [&](std::uint32_t reference) {
      const RowCost cost = forest.cost(r, reference);
      const bool stands = reference == no_row || reference == outside || reference >= first;
      if (stands && r > first && r - first < limits.group) {
        const std::uint64_t units = cost.units + bit_unit * (reference == no_row    ? r - first + 1
                                                             : reference == outside ? r - first
                                                                                    : r - 1 - reference);
        const double time = chain[r - 1] + cost.microseconds;
        if (time <= longest && units < best.units)
          best = {units, reference, true, cost.raw, time, parts[r - 1]};
      }
      const std::uint64_t units = cost.units + new_group;
      const double time = (reference == no_row ? 0 : chain[reference]) + cost.microseconds;
      const std::uint32_t count = 1 + (reference == no_row ? 0 : parts[reference]);
      if ((reference == no_row || (time <= longest && count <= ModelledRowFormat::longest_chain)) &&
          units < best.units)
        best = {units, reference, false, cost.raw, time, count};
    };
    offer(no_row);
    for (std::uint32_t row = first; row < r; ++row) offer(row);
    if (outside != no_row) offer(outside);
    for (const NearRow& other : near[r]) {
      if (other.row < r) offer(other.row);
    }
    forest.hang(r, best.reference);
    plan.reference.push_back(best.reference);
    plan.raw.push_back(best.raw);
    chain[r] = best.chain;
    parts[r] = best.parts;
    if (!best.joins) {
      first = r;
      outside = best.reference;
      plan.group_sizes.push_back(0);
    }
    ++plan.group_sizes.back();
  }
  return plan;
}

// Shares of the work, in per cent, whatever stages it has: the search for near rows, then the plan.
constexpr std::uint64_t searching = 40;
Progress part_of(const Progress& whole, std::uint64_t from, std::uint64_t to) {
  if (!whole) return {};
  return [&whole, from, to](std::uint64_t done, std::uint64_t total) {
    whole(from + (to - from) * done / std::max<std::uint64_t>(total, 1), 100);
  };
}

}  // namespace

RowPlan plan_rows(const RowEnds& ends, const RowLimits& limits, const EncodeOptions& options) {
  const Stages stages = [&](const char*) { return part_of(options.progress, 0, searching); };
  const NearRows near = near_rows(ends, options.threads, stages);
  const Progress planning = part_of(options.progress, searching, 100);
  return options.rows_may_move ? plan_tree(ends, near, limits, options.threads, planning)
                               : plan_in_order(ends, near, limits, planning);
}

}  // namespace vismat
