// ALGORITHM. The tree of references: Prim's over near rows by the sum of both distances, then each row moves under the
// near row under which it takes the fewest bits, a few times over. (Prim's by the one-way distance alone loses what the
// one-way distance gains.) The rows to keep are grown from the top of the tree, always by the row with the most time below
// it. Then rows move again, with a price on chains that are too long, until none is. Groups are cut so that a chain passes
// no row in vain: a group begins with a path down the tree; what hangs off that path with no group below it fills it up.
//
// In a round of moves all rows choose at once, which threads share, by the tree as it was before. Then the moves are made
// one after another, each only if it still saves bits. What a row costs under a near row is computed again only where that
// one's own reference has changed.
#include "codecs/modelled/reference_tree.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "codecs/modelled/row_forest.h"
#include "matrix/base/parallel.h"
#include "matrix/points/inverted_index.h"
#include "matrix/points/sparse_points.h"

namespace vismat {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

class ReferenceTree {
 public:
  ReferenceTree(const RowEnds& ends, const NearRows& near, const RowLimits& limits, unsigned threads,
                const Progress& progress)
      : limits_(limits),
        threads_(threads),
        progress_(progress),
        forest_(ends, *limits.weights),
        kept_(ends.rows()),
        near_(ends.rows()),
        now_(ends.rows()) {
    for (std::uint32_t r = 0; r < ends.rows(); ++r) {
      for (const NearRow& other : near[r]) near_[r].push_back({other.row});
    }
    grow(near);
    for (int round = 0; round < free_rounds; ++round) improve(unbounded);
    choose_kept();
    shorten();
    for (int round = 0; round < bounded_rounds; ++round) improve(longest());
    bound();
  }

  RowPlan plan() {
    RowPlan plan;
    const Lists children = forest_.children();
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
        return height_[a] != height_[b] ? height_[a] > height_[b] : a < b;
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
      std::vector<std::uint32_t> members;
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
                   : a.row < b.row;
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
        return height_[a] != height_[b] ? height_[a] < height_[b] : a < b;
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
  static constexpr int free_rounds = 3, bounded_rounds = 3, shortenings = 16;
  static constexpr double unbounded = 1e300;
  // The progress of the next of these rounds; the first is growing the tree.
  Progress step() {
    if (!progress_) return {};
    return [this, done = steps_++](std::uint64_t part, std::uint64_t whole) {
      progress_(done * whole + part, (1 + free_rounds + bounded_rounds) * whole);
    };
  }
  // Leaves some time for rows that share a group.
  double longest() const { return limits_.microseconds * .92; }

  // A row to stand under, and what that takes while it has the reference `under`.
  struct Candidate {
    std::uint32_t row;
    std::uint32_t under = no_row;
    std::int64_t units = -1;  // not known yet
    double microseconds = 0;
  };
  std::int64_t units(std::uint32_t row, std::uint32_t a, std::uint32_t b) const {
    return static_cast<std::int64_t>(forest_.cost(row, a, b).units);
  }
  const Candidate& cost_under(std::uint32_t row, Candidate& candidate) const {
    const std::uint32_t under = forest_.parent(candidate.row);
    if (candidate.units < 0 || candidate.under != under) {
      const RowCost cost = forest_.cost(row, candidate.row, under);
      candidate = {candidate.row, under, static_cast<std::int64_t>(cost.units), cost.microseconds};
    }
    return candidate;
  }
  // How many bits more the rows under the row take, whose second reference changes.
  std::int64_t extra_below(std::uint32_t row, std::uint32_t reference) const {
    std::int64_t sum = 0;
    for (const std::uint32_t child : children_[row]) sum += units(child, row, reference) - now_[child];
    return sum;
  }

  void grow(const NearRows& near) {
    using Edge = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // length, row, reference
    std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
    std::vector<bool> in(forest_.rows());
    std::vector<std::vector<NearRow>> of_whom(forest_.rows());  // the rows whose list has this one
    for (std::uint32_t r = 0; r < forest_.rows(); ++r) {
      for (const NearRow& other : near[r]) of_whom[other.row].push_back({r, other.differ});
      edges.emplace(6 * forest_.ends(r).count, r, no_row);
    }
    while (!edges.empty()) {
      const auto [length, row, reference] = edges.top();
      edges.pop();
      if (in[row]) continue;
      in[row] = true;
      forest_.hang(row, reference);
      for (const std::vector<NearRow>& list :
           {std::cref(near[row]), std::cref(std::as_const(of_whom[row]))}) {
        for (const NearRow& other : list) {
          if (!in[other.row]) edges.emplace((1 + lacked_end) * other.differ, other.row, row);
        }
      }
    }
    parallel_for(
        forest_.rows(), threads_, [&](std::uint64_t row) { price(static_cast<std::uint32_t>(row)); }, step());
  }
  void price(std::uint32_t row) { now_[row] = static_cast<std::int64_t>(forest_.price(row).units); }

  // For each row the time of the longest chain below it and of all below, and how many rows those are, itself included; the
  // time of the chain above it with itself; and its place in the order from the roots down.
  void measure(const Lists& children) {
    std::vector<std::uint32_t> down = children[forest_.rows()];
    for (std::size_t i = 0; i < down.size(); ++i)
      down.insert(down.end(), children[down[i]].begin(), children[down[i]].end());
    height_.assign(forest_.rows(), 0);
    size_.assign(forest_.rows(), 1);
    time_below_.assign(forest_.rows(), 0);
    chain_.resize(forest_.rows());
    for (const std::uint32_t r : down) {
      const std::uint32_t parent = forest_.parent(r);
      chain_[r] = kept_[r] ? 0 : forest_.time(r) + (parent == no_row ? 0 : chain_[parent]);
    }
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
  void measure_all() {
    children_ = forest_.children();
    measure(children_);
  }
  // The time of the row and of the rows that are not kept above it.
  double chain(std::uint32_t row) const {
    double sum = 0;
    for (; row != no_row && !kept_[row]; row = forest_.parent(row)) sum += forest_.time(row);
    return sum;
  }
  void move(std::uint32_t row, std::uint32_t reference) {
    auto& siblings = children_[std::min(forest_.parent(row), forest_.rows())];
    siblings.erase(std::ranges::find(siblings, row));
    const std::uint32_t old = forest_.parent(row);
    forest_.hang(row, reference);
    price(row);
    for (const std::uint32_t child : children_[row]) price(child);
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

  // Moves rows under the near row that saves the most bits, where no chain gets longer than that by it.
  void improve(double longest) {
    measure_all();
    std::vector<std::uint32_t> best(forest_.rows(), no_row);
    parallel_for(
        forest_.rows(), threads_,
        [&](std::uint64_t i) {
          const auto r = static_cast<std::uint32_t>(i);
          if (kept_[r]) return;
          std::int64_t least = 0;
          for (Candidate& other : near_[r]) {
            if (other.row == forest_.parent(r) || chain_[other.row] + height_[r] > longest) continue;
            std::int64_t more = cost_under(r, other).units - now_[r];
            if (more >= least || forest_.below(other.row, r)) continue;
            more += extra_below(r, other.row);
            if (more < least) least = more, best[r] = other.row;
          }
        },
        step());
    for (std::uint32_t r = 0; r < forest_.rows(); ++r) {
      const std::uint32_t other = best[r];
      if (other == no_row || chain(other) + height_[r] > longest || forest_.below(other, r)) continue;
      const std::int64_t own = units(r, other, forest_.parent(other)) - now_[r];
      if (own < 0 && own + extra_below(r, other) < 0) move(r, other);
    }
  }
  // Makes chains that are too long shorter, always where that takes the fewest bits for the time that it saves.
  void shorten() {
    struct Cut {
      double price = unbounded;
      std::uint32_t row = no_row, reference = no_row;
    };
    for (int round = 0; round < shortenings; ++round) {
      measure_all();
      std::vector<Cut> cuts(forest_.rows());
      parallel_for(forest_.rows(), threads_, [&](std::uint64_t i) {
        const auto r = static_cast<std::uint32_t>(i);
        const std::uint32_t parent = forest_.parent(r);
        const double over = (parent == no_row ? 0 : chain_[parent]) + height_[r] - longest();
        if (over <= 0 || kept_[r]) return;
        for (Candidate& other : near_[r]) {
          const double then = std::max(0., chain_[other.row] + height_[r] - longest());
          if (then >= over || forest_.below(other.row, r)) continue;
          const std::int64_t own = cost_under(r, other).units - now_[r];
          const auto price = [&](std::int64_t more) {
            return (static_cast<double>(more) + bit_unit) / (over - then);
          };
          if (price(own) >= cuts[r].price) continue;
          if (const double whole = price(own + extra_below(r, other.row)); whole < cuts[r].price)
            cuts[r] = {whole, r, other.row};
        }
      });
      std::erase_if(cuts, [](const Cut& cut) { return cut.reference == no_row; });
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
    const Lists children = forest_.children();
    measure(children);
    std::priority_queue<std::pair<double, std::uint32_t>> open;
    const auto offer = [&](std::uint32_t row) {
      for (const std::uint32_t child : children[std::min(row, forest_.rows())])
        open.emplace(height_[child], child);
    };
    offer(no_row);
    for (std::uint32_t left = std::min(limits_.kept, forest_.rows() / 4); left > 0 && !open.empty(); --left) {
      const std::uint32_t r = open.top().second;
      open.pop();
      kept_[r] = true;
      kept_order_.push_back(r);
      offer(r);
    }
    // Any row may take a kept one, however far it is.
    const auto kept = static_cast<std::uint32_t>(kept_order_.size());
    const auto ends_of = [&](std::uint32_t row) {
      const Ends ends = forest_.ends(row);
      return std::span(ends.at, ends.count);
    };
    const InvertedIndex index(kept, forest_.columns(),
                              [&](std::uint32_t i) { return ends_of(kept_order_[i]); });
    parallel_for(forest_.rows(), threads_, [&](std::uint64_t row) {
      const auto r = static_cast<std::uint32_t>(row);
      std::vector<std::uint32_t> common(kept);
      index.count_common(ends_of(r), common.data());
      std::vector<std::pair<std::uint32_t, std::uint32_t>> ranked;
      for (std::uint32_t i = 0; i < kept; ++i) {
        const std::uint32_t mine = forest_.ends(r).count, its = forest_.ends(kept_order_[i]).count;
        ranked.emplace_back(distance_with(lacked_end, mine + its - 2 * common[i], mine, its), kept_order_[i]);
      }
      const std::size_t count = std::min<std::size_t>(4, kept);
      std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
      ranked.resize(count);
      for (const auto& [distance, other] : ranked) {
        if (other != r && std::ranges::find(near_[r], other, &Candidate::row) == near_[r].end())
          near_[r].push_back({other});
      }
    });
  }
  // Gives each row whose chain is still too long a reference with a shorter one.
  void bound() {
    const Lists children = forest_.children();
    std::vector<std::uint32_t> down = children[forest_.rows()];
    for (std::size_t i = 0; i < down.size(); ++i) {
      const std::uint32_t r = down[i];
      if (chain(r) > longest()) {
        std::uint32_t best = no_row;
        std::int64_t least = units(r, no_row, no_row);
        for (Candidate& other : near_[r]) {
          const Candidate& cost = cost_under(r, other);
          if (chain(other.row) + cost.microseconds <= longest() && cost.units < least &&
              !forest_.below(other.row, r))
            least = cost.units, best = other.row;
        }
        forest_.hang(r, best);
        price(r);
        for (const std::uint32_t child : children[r]) price(child);
      }
      down.insert(down.end(), children[r].begin(), children[r].end());
    }
  }

  const RowLimits& limits_;
  unsigned threads_;
  const Progress& progress_;
  std::uint64_t steps_ = 0;
  RowForest forest_;
  std::vector<bool> kept_;
  std::vector<std::uint32_t> kept_order_;
  std::vector<std::vector<Candidate>> near_;
  Lists children_;                 // of no_row at the end
  std::vector<std::int64_t> now_;  // the units that each row takes
  std::vector<double> height_, time_below_, chain_;
  std::vector<std::uint32_t> size_;
};

}  // namespace

RowPlan plan_tree(const RowEnds& ends, const NearRows& near, const RowLimits& limits, unsigned threads,
                  const Progress& progress) {
  return ReferenceTree(ends, near, limits, threads, progress).plan();
}

}  // namespace vismat
