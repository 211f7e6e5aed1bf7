// ALGORITHM. The tree of references: Prim's over near rows by the sum of both distances, then each row moves under the
// near row under which it takes the fewest bits, a few times over. (Prim's by the one-way distance alone loses what the
// one-way distance gains.) The rows to keep are grown from the top of the tree, always by the row with the most time below
// it. Then rows move again, with a price on chains that are too long, until none is. Groups are cut so that a chain passes
// no row in vain: a group begins with a path down the tree; what hangs off that path with no group below it fills it up.
//
// Every choice depends on what the rows hold, not on their numbers. So the matrix in the order that was found gives the same
// tree, and that order again.
#include "codecs/modelled/row_references.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "codecs/modelled/near_rows.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

// How many near rows to try for each; fewer where each trial takes long.
std::uint32_t candidates_per_row(const RowEnds& ends) {
  std::uint64_t sum = 1;
  for (std::uint32_t r = 0; r < ends.rows(); ++r) sum += ends[r].count;
  return static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(std::uint64_t{6400} * ends.rows() / sum, 8, 32));
}

std::uint32_t kept_rows(std::uint32_t rows, const RowLimits& limits) {
  return std::min(limits.kept, rows / 4);
}

// The rows as a forest: each has a reference, or none.
class Forest {
 public:
  Forest(const RowEnds& ends, const RowWeights& weights)
      : ends_(ends), weights_(weights), parent_(ends.rows(), no_row), time_(ends.rows()) {}
  std::uint32_t rows() const { return ends_.rows(); }
  std::uint32_t parent(std::uint32_t row) const { return row == no_row ? no_row : parent_[row]; }
  double time(std::uint32_t row) const { return time_[row]; }  // of decoding this row alone
  void set(std::uint32_t row, std::uint32_t reference) {
    parent_[row] = reference;
    time_[row] = cost(row, reference).microseconds;
  }
  Ends ends(std::uint32_t row) const { return ends_[row == no_row ? ends_.rows() : row]; }
  RowCost cost(std::uint32_t row, std::uint32_t a, std::uint32_t b) const {
    return cost_of_row(ends(a), ends(b), ends(row), ends_.columns(), weights_);
  }
  RowCost cost(std::uint32_t row, std::uint32_t reference) const {
    return cost(row, reference, parent(reference));
  }
  bool below(std::uint32_t row, std::uint32_t ancestor) const {
    for (; row != no_row; row = parent_[row]) {
      if (row == ancestor) return true;
    }
    return false;
  }
  // Of each row, and of no_row at the end, in the order given.
  std::vector<std::vector<std::uint32_t>> children(const std::vector<std::uint32_t>& order) const {
    std::vector<std::vector<std::uint32_t>> all(rows() + 1);
    for (const std::uint32_t r : order) all[std::min(parent_[r], rows())].push_back(r);
    return all;
  }

 private:
  const RowEnds& ends_;
  const RowWeights& weights_;
  std::vector<std::uint32_t> parent_;
  std::vector<double> time_;
};

using Lists = std::vector<std::vector<std::uint32_t>>;

// Numbers that rows are told apart by, from what they hold.
std::vector<std::uint64_t> names_of(const RowEnds& ends) {
  std::vector<std::uint64_t> names(ends.rows());
  for (std::uint32_t r = 0; r < ends.rows(); ++r) {
    for (std::uint32_t i = 0; i < ends[r].count; ++i) names[r] = Random(names[r] + ends[r].at[i]).next();
  }
  return names;
}

struct NamedRows {
  std::vector<std::uint64_t> names;
  Lists near;  // near rows of each
};

NamedRows named_rows(const VisibilityMatrix& matrix, const RowEnds& ends, unsigned threads) {
  NamedRows rows{names_of(ends), {}};
  rows.near = near_rows(matrix, ends, rows.names, candidates_per_row(ends), threads);
  return rows;
}

class TreePlanner {
 public:
  TreePlanner(const RowEnds& ends, NamedRows rows, const RowLimits& limits)
      : limits_(limits),
        names_(std::move(rows.names)),
        forest_(ends, *limits.weights),
        kept_(ends.rows()),
        by_name_(ends.rows()),
        near_(std::move(rows.near)) {
    std::iota(by_name_.begin(), by_name_.end(), 0u);
    std::ranges::sort(by_name_, [&](std::uint32_t a, std::uint32_t b) { return before(a, b); });
    grow();
    for (int pass = 0; pass < 2; ++pass) improve(unbounded);
    choose_kept();
    shorten();
    for (int pass = 0; pass < 2; ++pass) improve(longest());
    bound();
  }

  RowPlan plan() {
    RowPlan plan;
    const Lists children = forest_.children(by_name_);
    measure(children);
    std::vector<std::uint32_t> place(forest_.rows(), no_row);
    std::vector<double> taken(
        forest_.rows());  // the time to decode a row that is not kept with all that it takes
    double now = 0;       // the same, of the last row put
    const auto put = [&](std::uint32_t row) {
      now += forest_.time(row);
      taken[row] = now;
      place[row] = static_cast<std::uint32_t>(plan.order.size());
      plan.order.push_back(row);
      const std::uint32_t parent = forest_.parent(row);
      plan.reference.push_back(parent == no_row ? no_row : place[parent]);
    };
    // Children with much below them first: so the chain that a long one takes has few groups.
    const auto sorted = [&](std::uint32_t row) {
      auto all = children[std::min(row, forest_.rows())];
      std::ranges::sort(all, [&](std::uint32_t a, std::uint32_t b) {
        return height_[a] != height_[b] ? height_[a] > height_[b] : before(a, b);
      });
      return all;
    };
    const std::function<void(std::uint32_t)> put_kept = [&](std::uint32_t row) {
      for (const std::uint32_t child : sorted(row)) {
        if (!kept_[child]) continue;
        put(child);
        put_kept(child);
      }
    };
    put_kept(no_row);
    plan.kept = static_cast<std::uint32_t>(plan.order.size());
    const auto kept_order = plan.order;
    std::vector<std::uint32_t> stack;  // roots of groups to come
    const auto group_from = [&](std::uint32_t root) {
      const std::size_t first = plan.order.size();
      std::vector<std::uint32_t> members, open;
      const auto fits = [&](std::uint32_t row) {
        return size_[row] <= limits_.group - (plan.order.size() - first) &&
               now + time_below_[row] <= limits_.microseconds;
      };
      const std::uint32_t above = forest_.parent(root);
      now = above == no_row || kept_[above] ? 0 : taken[above];
      put(root);
      members.push_back(root);
      // The path down, as long as the group's share for it lasts.
      for (std::uint32_t row = root; plan.order.size() - first < (limits_.group + 1) / 2;) {
        const auto below = sorted(row);
        if (below.empty()) break;
        row = below[0];
        put(row);
        members.push_back(row);
      }
      // What hangs off it and fits as a whole, within the limit of time, the smallest first; then anything else begins a group of its own.
      struct Hanging {
        std::uint32_t size, row;
      };
      std::vector<Hanging> hanging;
      for (const std::uint32_t row : members) {
        for (const std::uint32_t child : children[row]) {
          if (place[child] == no_row) hanging.push_back({size_[child], child});
        }
      }
      std::ranges::sort(hanging, [&](const Hanging& a, const Hanging& b) {
        return a.size != b.size ? a.size < b.size
               : place[forest_.parent(a.row)] != place[forest_.parent(b.row)]
                   ? place[forest_.parent(a.row)] > place[forest_.parent(b.row)]
                   : before(a.row, b.row);
      });
      const std::function<void(std::uint32_t)> put_all = [&](std::uint32_t row) {
        put(row);
        for (const std::uint32_t child : sorted(row)) put_all(child);
      };
      std::vector<std::uint32_t> later;
      for (const Hanging& h : hanging) {
        if (fits(h.row))
          put_all(h.row);
        else
          later.push_back(h.row);
      }
      plan.group_sizes.push_back(static_cast<std::uint32_t>(plan.order.size() - first));
      std::ranges::sort(later, [&](std::uint32_t a, std::uint32_t b) {
        return height_[a] != height_[b] ? height_[a] < height_[b] : before(a, b);
      });
      stack.insert(stack.end(), later.begin(), later.end());
    };
    const auto groups_below = [&](std::uint32_t row) {
      for (const std::uint32_t child : sorted(row)) {
        if (kept_[child]) continue;
        stack.push_back(child);
        while (!stack.empty()) {
          const std::uint32_t root = stack.back();
          stack.pop_back();
          group_from(root);
        }
      }
    };
    groups_below(no_row);
    for (const std::uint32_t row : kept_order) groups_below(row);
    for (const std::uint32_t row : plan.order) plan.raw.push_back(forest_.cost(row, forest_.parent(row)).raw);
    return plan;
  }

 private:
  bool before(std::uint32_t a, std::uint32_t b) const {
    return names_[a] != names_[b] ? names_[a] < names_[b] : a < b;
  }
  void grow() {
    using Edge = std::tuple<std::uint32_t, std::uint64_t, std::uint32_t, std::uint64_t, std::uint32_t>;
    std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
    std::vector<bool> in(forest_.rows());
    Lists near_whom(forest_.rows());
    for (const std::uint32_t r : by_name_) {
      for (const std::uint32_t other : near_[r]) near_whom[other].push_back(r);
      edges.emplace(6 * forest_.ends(r).count, names_[r], r, 0, no_row);
    }
    while (!edges.empty()) {
      const auto [length, name, row, reference_name, reference] = edges.top();
      edges.pop();
      if (in[row]) continue;
      in[row] = true;
      forest_.set(row, reference);
      for (const Lists* lists : {&near_, &near_whom}) {
        for (const std::uint32_t other : (*lists)[row]) {
          if (in[other]) continue;
          const std::uint32_t both = reference_distance(forest_.ends(row), forest_.ends(other)) +
                                     reference_distance(forest_.ends(other), forest_.ends(row));
          edges.emplace(both, names_[other], other, names_[row], row);
        }
      }
    }
  }
  // For each row the time of the longest chain below it, and how many rows are below; itself included.
  void measure(const Lists& children) {
    std::vector<std::uint32_t> down = children[forest_.rows()];
    for (std::size_t i = 0; i < down.size(); ++i)
      down.insert(down.end(), children[down[i]].begin(), children[down[i]].end());
    height_.assign(forest_.rows(), 0);
    size_.assign(forest_.rows(), 1);
    time_below_.assign(forest_.rows(), 0);
    for (std::size_t i = down.size(); i-- > 0;) {
      const std::uint32_t r = down[i];
      for (const std::uint32_t child : children[r]) {
        height_[r] = std::max(height_[r], height_[child]);
        size_[r] += size_[child];
        time_below_[r] += time_below_[child];
      }
      height_[r] += forest_.time(r);
      time_below_[r] += forest_.time(r);
    }
  }
  // The time of the row and of the rows that are not kept above it.
  double chain(std::uint32_t row) const {
    double sum = 0;
    for (; row != no_row && !kept_[row]; row = forest_.parent(row)) sum += forest_.time(row);
    return sum;
  }
  static constexpr double unbounded = 1e300;
  // Leaves some time for rows that share a group.
  double longest() const { return limits_.microseconds * .92; }
  // How many bits more it takes if the row moves under another reference: its own, and those of the rows under it, whose
  // second reference changes.
  std::int64_t extra(std::uint32_t row, std::uint32_t reference, std::int64_t enough) const {
    std::int64_t sum = units(row, reference, forest_.parent(reference)) - now_[row];
    if (sum >= enough) return sum;
    for (const std::uint32_t child : children_[row]) sum += units(child, row, reference) - now_[child];
    return sum;
  }
  std::int64_t units(std::uint32_t row, std::uint32_t a, std::uint32_t b) const {
    return static_cast<std::int64_t>(forest_.cost(row, a, b).units);
  }
  void move(std::uint32_t row, std::uint32_t reference) {
    auto& siblings = children_[std::min(forest_.parent(row), forest_.rows())];
    siblings.erase(std::ranges::find(siblings, row));
    const std::uint32_t old = forest_.parent(row);
    forest_.set(row, reference);
    now_[row] = units(row, reference, forest_.parent(reference));
    for (const std::uint32_t child : children_[row]) {
      forest_.set(child, row);
      now_[child] = units(child, row, reference);
    }
    children_[std::min(reference, forest_.rows())].push_back(row);
    renew_heights(row);
    renew_heights(old);
  }
  void renew_heights(std::uint32_t row) {
    for (; row != no_row; row = forest_.parent(row)) {
      double height = 0;
      for (const std::uint32_t child : children_[row]) height = std::max(height, height_[child]);
      height_[row] = height + forest_.time(row);
    }
  }
  void measure_all() {
    children_ = forest_.children(by_name_);
    measure(children_);
    now_.resize(forest_.rows());
    for (const std::uint32_t r : by_name_)
      now_[r] = units(r, forest_.parent(r), forest_.parent(forest_.parent(r)));
  }
  // Moves rows under the near row that saves the most bits, where no chain gets longer than that by it.
  void improve(double longest) {
    measure_all();
    for (const std::uint32_t r : by_name_) {
      if (kept_[r]) continue;
      std::uint32_t best = no_row;
      std::int64_t least = 0;
      for (const std::uint32_t other : near_[r]) {
        if (other == forest_.parent(r) || chain(other) + height_[r] > longest || forest_.below(other, r))
          continue;
        const std::int64_t more = extra(r, other, least);
        if (more < least) least = more, best = other;
      }
      if (least < 0) move(r, best);
    }
  }
  // Makes chains that are too long shorter, always where that takes the fewest bits for the time that it saves.
  void shorten() {
    for (int round = 0; round < 16; ++round) {
      measure_all();
      struct Cut {
        double price;
        std::uint32_t row, reference;
      };
      std::vector<Cut> cuts;
      for (const std::uint32_t r : by_name_) {
        const double over = chain(forest_.parent(r)) + height_[r] - longest();
        if (over <= 0 || kept_[r]) continue;
        Cut best{unbounded, r, no_row};
        for (const std::uint32_t other : near_[r]) {
          const double then = std::max(0., chain(other) + height_[r] - longest());
          if (then >= over || forest_.below(other, r)) continue;
          const double price =
              (static_cast<double>(extra(r, other, std::int64_t{1} << 60)) + bit_unit) / (over - then);
          if (price < best.price) best.price = price, best.reference = other;
        }
        if (best.reference != no_row) cuts.push_back(best);
      }
      if (cuts.empty()) return;
      std::ranges::stable_sort(cuts, {}, &Cut::price);
      bool moved = false;
      for (const Cut& cut : cuts) {
        const double over = chain(forest_.parent(cut.row)) + height_[cut.row] - longest();
        const double then = std::max(0., chain(cut.reference) + height_[cut.row] - longest());
        if (over > 0 && then < over && !forest_.below(cut.reference, cut.row)) {
          move(cut.row, cut.reference);
          moved = true;
        }
      }
      if (!moved) return;
    }
  }
  void choose_kept() {
    const Lists children = forest_.children(by_name_);
    measure(children);
    using Item = std::tuple<double, std::uint64_t, std::uint32_t>;
    std::priority_queue<Item> open;
    const auto offer = [&](std::uint32_t row) {
      for (const std::uint32_t child : children[std::min(row, forest_.rows())])
        open.emplace(height_[child], names_[child], child);
    };
    offer(no_row);
    for (std::uint32_t left = kept_rows(forest_.rows(), limits_); left > 0 && !open.empty(); --left) {
      const std::uint32_t r = std::get<2>(open.top());
      open.pop();
      kept_[r] = true;
      kept_order_.push_back(r);
      offer(r);
    }
    // Any row may take a kept one, however far it is.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranked;
    for (std::uint32_t r = 0; r < forest_.rows(); ++r) {
      ranked.clear();
      for (std::uint32_t i = 0; i < kept_order_.size(); ++i)
        ranked.emplace_back(reference_distance(forest_.ends(kept_order_[i]), forest_.ends(r)), i);
      const auto count = static_cast<std::ptrdiff_t>(std::min<std::size_t>(4, ranked.size()));
      std::partial_sort(ranked.begin(), ranked.begin() + count, ranked.end());
      for (std::ptrdiff_t i = 0; i < count; ++i) {
        const std::uint32_t other = kept_order_[ranked[static_cast<std::size_t>(i)].second];
        if (other != r && std::ranges::find(near_[r], other) == near_[r].end()) near_[r].push_back(other);
      }
    }
  }
  // Gives each row whose chain is still too long a reference with a shorter one.
  void bound() {
    const Lists children = forest_.children(by_name_);
    std::vector<std::uint32_t> down = children[forest_.rows()];
    for (std::size_t i = 0; i < down.size(); ++i) {
      const std::uint32_t r = down[i];
      if (chain(r) > longest()) {
        std::uint32_t best = no_row;
        std::uint64_t least = forest_.cost(r, no_row).units;
        const auto offer = [&](std::uint32_t other) {
          const RowCost cost = forest_.cost(r, other);
          if (chain(other) + cost.microseconds <= longest() && cost.units < least && !forest_.below(other, r))
            least = cost.units, best = other;
        };
        for (const std::uint32_t other : near_[r]) offer(other);
        for (const std::uint32_t other : kept_order_) offer(other);
        forest_.set(r, best);
      }
      down.insert(down.end(), children[r].begin(), children[r].end());
    }
  }

  const RowLimits& limits_;
  std::vector<std::uint64_t> names_;
  Forest forest_;
  std::vector<bool> kept_;
  std::vector<std::uint32_t> kept_order_, by_name_;
  Lists near_;
  Lists children_;                 // of no_row at the end
  std::vector<std::int64_t> now_;  // the units that each row takes
  std::vector<double> height_, time_below_;
  std::vector<std::uint32_t> size_;
};

// References among earlier rows, in the order in which rows stand.
RowPlan plan_in_order(const RowEnds& ends, const Lists& near, const RowLimits& limits) {
  constexpr std::uint64_t new_group = 28 * bit_unit;
  const std::uint32_t rows = ends.rows();
  RowPlan plan;
  plan.order.resize(rows);
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  Forest forest(ends, *limits.weights);
  // Differences between view cells are much shorter than rows of view cells, and read more often.
  double sum = 0;
  for (std::uint32_t r = 0; r < rows; ++r)
    sum += forest.cost(r, near[r].empty() ? no_row : near[r][0]).microseconds;
  const double longest = std::min(limits.microseconds, limits.mean_rows * sum / rows);
  std::vector<double> chain(rows);            // the time of a row and of all that it takes
  std::vector<std::uint32_t> parts(rows);     // that it takes
  std::uint32_t first = 0, outside = no_row;  // of the group
  for (std::uint32_t r = 0; r < rows; ++r) {
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
    for (const std::uint32_t other : near[r]) {
      if (other < r) offer(other);
    }
    forest.set(r, best.reference);
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

}  // namespace

Permutation order_for_references(const VisibilityMatrix& matrix, const RowLimits& limits, unsigned threads) {
  const RowEnds ends(matrix);
  return Permutation::from_old_of_new(
      TreePlanner(ends, named_rows(matrix, ends, threads), limits).plan().order);
}

RowPlan plan_rows(const VisibilityMatrix& matrix, const RowEnds& ends, const RowLimits& limits,
                  unsigned threads) {
  const NamedRows rows = named_rows(matrix, ends, threads);
  RowPlan plan = TreePlanner(ends, rows, limits).plan();
  return std::ranges::is_sorted(plan.order) ? plan : plan_in_order(ends, rows.near, limits);
}

}  // namespace vismat
