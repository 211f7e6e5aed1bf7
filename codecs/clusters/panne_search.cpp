#include "codecs/clusters/panne_search.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "matrix/base/random.h"

namespace vismat {
namespace {

using Clock = std::chrono::steady_clock;

// How many candidates a list gets: those within `window` places of it in each of `tables` orders by min-hash, and in the matrix.
struct Effort {
  unsigned tables, window;
};

constexpr std::size_t most_seen = 2048;

struct Pair {
  std::int64_t saved = 0;
  std::uint32_t a = 0, b = 0;  // a < b
};

bool saves_more(const Pair& x, const Pair& y) {
  if (x.saved != y.saved) return x.saved > y.saved;
  return x.a != y.a ? x.a < y.a : x.b < y.b;
}

class Search {
 public:
  Search(const VisibilityMatrix& matrix, const PanneSearch& options)
      : options_(options), table_(matrix), random_(options.seed), start_(Clock::now()) {}

  Search(PanneTable table, const PanneSearch& options)
      : options_(options), table_(std::move(table)), random_(options.seed), start_(Clock::now()) {}

  PanneTable run(const VisibilityMatrix& matrix) {
    if (matrix.shape().columns > PanneTable::most_columns) return std::move(table_);
    end_round();
    const Effort first_effort{2, 6};
    group_equal_columns(matrix, first_effort);
    for (std::uint64_t before = 0; !over();) {
      before = table_.price();
      all_rounds(first_effort);
      if (table_.price() + before / 200 >= before) break;
    }
    while (options_.seconds > 0 && !over() && table_.clusters() > 0) try_otherwise();
    if (options_.progress) options_.progress(1, 1);
    return std::move(table_);
  }

 private:
  std::int64_t elapsed() const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start_).count();
  }
  bool over() const {
    return options_.seconds > 0 && static_cast<double>(elapsed()) >= options_.seconds * 1000;
  }
  void stepped() {
    if (options_.after_step && !quiet_) options_.after_step(table_);
  }
  void end_round() {
    if (table_.dissolve() > 0) stepped();
    if (table_.settle()) stepped();
    ++done_;
    if (options_.progress) {
      if (options_.seconds > 0) {
        const auto total = static_cast<std::uint64_t>(options_.seconds * 1000);
        options_.progress(std::min(static_cast<std::uint64_t>(elapsed()), total - 1), total);
      } else {
        options_.progress(done_, std::max<std::uint64_t>(done_ + 1, 60));
      }
    }
    if (options_.after_round && !quiet_) {
      const auto paused = Clock::now();
      options_.after_round(table_);
      start_ += Clock::now() - paused;
    }
  }
  void all_rounds(Effort effort) {
    rounds(effort, [this](Known& known) { share_round(known); });
    rounds(effort, [this](Known& known) { join_round(known); });
  }
  // Stuck: some clusters are dissolved, and their members find other partners. The caller sees one step, if it saves.
  void try_otherwise() {
    const PanneTable before = table_;
    std::vector<bool> chosen(table_.clusters());
    for (std::size_t v = 0; v < chosen.size(); ++v) chosen[v] = random_.below(3) == 0;
    quiet_ = true;
    table_.loosen(chosen);
    end_round();
    all_rounds({4, 6});
    quiet_ = false;
    if (table_.price() >= before.price()) {
      table_ = before;
      return;
    }
    stepped();
    end_round();
  }
  // Groups of equal columns make later rounds faster, and often better even where they cost something at first: so that is tried
  // for a few rounds with and without them. To the caller it is one step, and only if it saves.
  void group_equal_columns(const VisibilityMatrix& matrix, Effort effort) {
    PanneTable grouped = table_;
    if (!grouped.group_equal_columns(matrix)) return;
    std::uint64_t members = 0;
    for (const auto& list : grouped.lists()) members += list.size();
    if (members + matrix.ones() / 16 > matrix.ones()) return;
    if (grouped.price() < table_.price() + table_.price() / 4) {
      const auto few_rounds = [&](PanneTable table) {
        PanneSearch quiet;
        quiet.threads = options_.threads;
        if (options_.seconds > 0)
          quiet.seconds = std::max(1e-9, options_.seconds - static_cast<double>(elapsed()) / 1000);
        Search trial(std::move(table), quiet);
        Known known = trial.begin(effort);
        for (int round = 0; round < 4 && !over(); ++round) {
          trial.share_round(known);
          trial.end_round();
        }
        return std::move(trial.table_);
      };
      PanneTable with = few_rounds(std::move(grouped));
      if (with.price() >= table_.price() || with.price() >= few_rounds(table_).price()) return;
      table_ = std::move(with);
      stepped();
      end_round();
    }
  }
  // Until one saves little.
  template <typename Round>
  void rounds(Effort effort, const Round& round) {
    Known known = begin(effort);
    for (std::uint64_t before = 0; !over();) {
      before = table_.price();
      round(known);
      end_round();
      if (table_.price() + before / (options_.seconds > 0 ? 1000 : 400) >= before) break;
    }
  }

  template <typename Work>
  void in_blocks(std::size_t count, const Work& work) {
    constexpr std::size_t block = 64;
    parallel_for((count + block - 1) / block, options_.threads, [&](std::uint64_t b) {
      if (over()) return;
      for (std::size_t i = b * block; i < std::min(count, (b + 1) * block); ++i) work(i);
    });
  }

  // What is known of items, lists or members, from round to round.
  struct Known {
    static constexpr std::size_t partners = 3;
    Effort effort{};
    std::vector<std::uint64_t> salts;                 // a table each
    std::vector<std::array<std::uint64_t, 2>> least;  // an item's hashes, table after table
    std::vector<std::array<Pair, partners>> best;     // with items of higher numbers
    std::vector<std::uint8_t> changed;                // since then
    std::vector<std::vector<std::uint32_t>> seen;     // of these, those that were looked at; ascending
    void resize(std::size_t items) {
      seen.resize(items);
      least.resize(items * effort.tables);
      best.resize(items);
      changed.resize(items, 1);
    }
  };
  Known begin(Effort effort) {
    Known known;
    known.effort = effort;
    for (unsigned t = 0; t < effort.tables; ++t) known.salts.push_back(random_.next());
    return known;
  }

  // Orders of the active items' numbers in which similar sets are near one another.
  template <typename Elements, typename Place>
  std::vector<std::vector<std::uint32_t>> orders_of(Known& known, std::span<const std::uint32_t> active,
                                                    const Elements& elements, const Place& in_matrix) {
    for (auto& salt : known.salts) salt = random_.next();
    const unsigned tables = known.effort.tables;
    in_blocks(active.size(), [&](std::size_t i) {
      const std::uint32_t item = active[i];
      for (unsigned t = 0; t < tables; ++t) {
        std::uint64_t a = ~std::uint64_t{0}, b = a;
        for (const std::uint32_t element : elements(item)) {
          const std::uint64_t hash = Random(known.salts[t] + element * 0x9e3779b97f4a7c15u).next();
          a = std::min(a, hash);
          b = std::min(b, std::uint64_t{hash * 0xd1342543de82ef95u});
        }
        known.least[std::size_t{item} * tables + t] = {a, b};
      }
    });
    std::vector<std::vector<std::uint32_t>> orders(tables + 1);
    parallel_for(tables + 1, options_.threads, [&](std::uint64_t t) {
      orders[t].assign(active.begin(), active.end());
      if (t == tables) {
        std::stable_sort(orders[t].begin(), orders[t].end(),
                         [&](std::uint32_t a, std::uint32_t b) { return in_matrix(a) < in_matrix(b); });
      } else {
        std::stable_sort(orders[t].begin(), orders[t].end(), [&](std::uint32_t a, std::uint32_t b) {
          return known.least[std::size_t{a} * tables + t] < known.least[std::size_t{b} * tables + t];
        });
      }
    });
    return orders;
  }

  // For each item the partners that save most, of those near it in any order: those with which it has most in common are
  // priced. A pair that was looked at before, and has not changed since, is not looked at again.
  template <typename Common, typename Saved>
  void find_partners(Known& known, std::span<const std::uint32_t> active,
                     const std::vector<std::vector<std::uint32_t>>& orders, const Common& common,
                     const Saved& saved) {
    std::vector<std::vector<std::uint32_t>> places(orders.size());
    for (std::size_t o = 0; o < orders.size(); ++o) {
      places[o].resize(known.best.size());
      for (std::uint32_t p = 0; p < orders[o].size(); ++p) places[o][orders[o][p]] = p;
    }
    in_blocks(active.size(), [&](std::size_t i) {
      const std::uint32_t item = active[i];
      auto& best = known.best[item];
      if (known.changed[item]) best = {};
      for (Pair& pair : best) {
        if (pair.saved > 0 && known.changed[pair.b]) pair = {};
      }
      auto& seen = known.seen[item];
      if (known.changed[item] || seen.size() > most_seen) seen.clear();
      std::erase_if(seen, [&](std::uint32_t other) { return known.changed[other]; });
      std::vector<std::uint32_t> near, all_seen;
      for (std::size_t o = 0; o < orders.size(); ++o) {
        const std::size_t place = places[o][item], window = known.effort.window;
        const std::size_t end = std::min(orders[o].size(), place + window + 1);
        for (std::size_t p = place - std::min(place, window); p < end; ++p) {
          if (orders[o][p] > item) near.push_back(orders[o][p]);
        }
      }
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      std::erase_if(near, [&, next = seen.begin()](std::uint32_t other) mutable {
        next = std::lower_bound(next, seen.end(), other);
        return next != seen.end() && *next == other;
      });
      std::ranges::set_union(seen, near, std::back_inserter(all_seen));
      seen = std::move(all_seen);
      std::vector<std::pair<std::uint32_t, std::uint32_t>> most;  // in common, partner
      for (const std::uint32_t other : near) {
        const std::uint32_t shared = common(item, other);
        if (shared >= 2) most.emplace_back(shared, other);
      }
      const std::size_t some = std::min(Known::partners, most.size());
      std::partial_sort(most.begin(), most.begin() + static_cast<std::ptrdiff_t>(some), most.end(),
                        [](const auto& x, const auto& y) {
                          return x.first != y.first ? x.first > y.first : x.second < y.second;
                        });
      std::array<Pair, 2 * Known::partners> all{};
      std::copy(best.begin(), best.end(), all.begin());
      for (std::size_t k = 0; k < some; ++k)
        all[Known::partners + k] = {saved(item, most[k].second), item, most[k].second};
      std::sort(all.begin(), all.end(), saves_more);
      std::copy_n(all.begin(), best.size(), best.begin());
    });
  }

  // Takes pairs from the one that saves most on, each item once; and none that saves much less than what either item could have
  // saved with another, as it may in the next round.
  template <typename Take>
  void take_pairs(Known& known, std::span<const std::uint32_t> active, const Take& take) {
    std::vector<std::int64_t> most(known.best.size(), 0);
    std::vector<Pair> pairs;
    for (const std::uint32_t item : active) {
      for (const Pair& pair : known.best[item]) {
        if (pair.saved <= 0) continue;
        pairs.push_back(pair);
        most[pair.a] = std::max(most[pair.a], pair.saved);
        most[pair.b] = std::max(most[pair.b], pair.saved);
      }
    }
    std::sort(pairs.begin(), pairs.end(), saves_more);
    std::fill(known.changed.begin(), known.changed.end(), 0);
    for (const Pair& pair : pairs) {
      if (over()) break;
      if (known.changed[pair.a] || known.changed[pair.b]) continue;
      if (pair.saved < std::max(most[pair.a], most[pair.b]) / 16 * 15) continue;
      if (take(pair.a, pair.b)) {
        known.changed[pair.a] = known.changed[pair.b] = 1;
        stepped();
      } else {  // prices have changed
        for (Pair& cached : known.best[pair.a]) {
          if (cached.b == pair.b) cached = {};
        }
      }
    }
  }

  void share_round(Known& known) {
    const auto lists = [this](std::uint32_t l) -> const PanneTable::List& { return table_.lists()[l]; };
    known.resize(table_.lists().size());
    std::vector<std::uint32_t> active;
    for (std::uint32_t l = 0; l < table_.lists().size(); ++l) {
      if (lists(l).size() >= 2) active.push_back(l);
    }
    const auto orders =
        orders_of(known, active, lists, [this](std::uint32_t l) { return table_.row_near(l); });
    const auto common = [&](std::uint32_t l, std::uint32_t m) {
      const PanneTable::List& a = lists(l);
      const PanneTable::List& b = lists(m);
      std::uint32_t shared = 0;
      for (std::size_t p = 0, q = 0; p < a.size() && q < b.size();) {
        const std::uint32_t first_a = table_.first(a[p]), first_b = table_.first(b[q]);
        shared += a[p] == b[q];
        p += first_a <= first_b;
        q += first_b <= first_a;
      }
      return shared;
    };
    find_partners(known, active, orders, common, [this](std::uint32_t a, std::uint32_t b) {
      static thread_local PanneTable::List memory;
      return table_.saved_by_sharing(a, b, memory);
    });
    take_pairs(known, active, [this](std::uint32_t a, std::uint32_t b) { return table_.share(a, b); });
  }

  void join_round(Known& known) {
    const auto lists = table_.lists();
    const std::uint32_t members = table_.shape().columns + table_.clusters();
    std::vector<std::uint64_t> begin(std::size_t{members} + 1, 0);  // of the lists that hold a member
    for (const auto& list : lists) {
      for (const std::uint32_t s : list) ++begin[s + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::uint32_t> holders(begin.back());
    {
      auto end = begin;
      for (std::uint32_t l = 0; l < lists.size(); ++l) {
        for (const std::uint32_t s : lists[l]) holders[end[s]++] = l;
      }
    }
    const auto of = [&](std::uint32_t s) {
      return std::span<const std::uint32_t>(holders).subspan(begin[s], begin[s + 1] - begin[s]);
    };
    known.resize(members);
    std::vector<std::uint32_t> active;
    for (std::uint32_t s = 0; s < members; ++s) {
      if (of(s).size() >= 2) active.push_back(s);
    }
    const auto orders = orders_of(known, active, of, [this](std::uint32_t s) { return table_.first(s); });
    const auto common = [&](std::uint32_t s, std::uint32_t t) {
      const auto a = of(s), b = of(t);
      std::uint32_t shared = 0;
      for (std::size_t p = 0, q = 0; p < a.size() && q < b.size();) {
        const std::uint32_t x = a[p], y = b[q];
        shared += x == y;
        p += x <= y;
        q += y <= x;
      }
      return shared;
    };
    const auto with_both = [&](std::uint32_t s, std::uint32_t t, const auto& work) {
      static thread_local PanneTable::List both;
      both.clear();
      std::ranges::set_intersection(of(s), of(t), std::back_inserter(both));
      if (table_.first(s) > table_.first(t)) std::swap(s, t);
      return work(s, t, both);
    };
    find_partners(known, active, orders, common, [&](std::uint32_t s, std::uint32_t t) {
      return with_both(s, t,
                       [&](auto x, auto y, const auto& both) { return table_.saved_by_joining(x, y, both); });
    });
    take_pairs(known, active, [&](std::uint32_t s, std::uint32_t t) {
      return with_both(s, t, [&](auto x, auto y, const auto& both) { return table_.join(x, y, both); });
    });
  }

  const PanneSearch& options_;
  PanneTable table_;
  Random random_;
  Clock::time_point start_;
  std::uint64_t done_ = 0;
  bool quiet_ = false;  // while what is tried may still be undone
};

}  // namespace

PanneTable search_clusters(const VisibilityMatrix& matrix, const PanneSearch& search) {
  return Search(matrix, search).run(matrix);
}

}  // namespace vismat
