// A visibility matrix from which common subsets are factored out [van de Panne & Stewart 1999], and what it takes to code it.
//
// A symbol is an object (a column) or a cluster: two or more symbols that several lists share. A list is a row or a cluster's
// content; its symbols' objects do not overlap. In terms of a graph of rows and columns, whoever sees a whole set C of
// columns from each of a set R of rows has |R| + |C| edges through a cluster, not |R| |C|.
//
// A symbol begins at its lowest object, first, and reaches as far as its objects are known to follow one another without a gap:
// an object to the column behind it; a cluster through its symbols in order, for as long as each begins where the one
// before reaches to. No two symbols of a list begin at the same column. So a list is told as
//
//   step     for each cluster and each maximal run of objects the zero run from where what stands before reaches to (0 at
//            first) up to its beginning, and which it is: an object alone, a longer run or a cluster; then
//   run      how many objects but one, or
//   rank     which of the clusters that begin there, from 1 on
//   lead     in place of a cluster's first step, as its beginning is known: its first symbol's rank, 0 for an object
//   end      behind the last step; a row without any is told by nothing
//   heads    and once for each column: how many clusters begin there
//
// Nothing of this changes in other lists when a cluster is added. Each number is one of the 168 symbols of
// run_length_symbols.h and raw bits; a symbol is priced at what its share of all numbers of its kind says, in 1/1024 bit. The prices
// stay as they are but for settle(), so what a change saves is known exactly from the lists that it touches.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/run_length_symbols.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// The kinds of numbers. The first four stand in one place, so their shares are of one total.
enum class PanneNumber { object_step, run_step, cluster_step, end, run, rank, lead, heads };
constexpr std::size_t panne_steps = 4, panne_numbers = 8;

class PannePrices {
 public:
  static constexpr std::uint64_t unit = 1024;  // a bit
  using Counts = std::array<std::array<std::uint64_t, LengthSymbol::count>, panne_numbers>;

  explicit PannePrices(Counts counts);
  /// Of a number of at least 1.
  std::uint64_t of(PanneNumber kind, std::uint32_t number) const {
    const auto& prices = small_[static_cast<std::size_t>(kind)];
    return number < prices.size() ? prices[number] : of_large(kind, number);
  }

 private:
  std::uint64_t of_large(PanneNumber kind, std::uint32_t number) const;
  std::array<std::array<std::uint32_t, LengthSymbol::count>, panne_numbers> of_symbol_;
  std::array<std::array<std::uint32_t, 512>, panne_numbers> small_;
};

class PanneTable {
 public:
  using List = std::vector<std::uint32_t>;
  static constexpr std::uint32_t most_columns = 1u << 24;  // what may have clusters

  /// Without clusters.
  explicit PanneTable(const VisibilityMatrix& matrix);

  Shape shape() const { return shape_; }
  std::uint32_t clusters() const { return static_cast<std::uint32_t>(clusters_.size()); }
  /// Rows 0, 1, ..., and behind them clusters; that of cluster symbol s is list rows + s - columns. Empty where a cluster is
  /// no more.
  std::span<const List> lists() const { return lists_; }
  bool is_row(std::uint32_t list) const { return list < shape_.rows; }
  std::uint32_t symbol_of_list(std::uint32_t list) const { return list - shape_.rows + shape_.columns; }
  std::uint32_t list_of_symbol(std::uint32_t symbol) const { return symbol - shape_.columns + shape_.rows; }
  bool is_object(std::uint32_t symbol) const { return symbol < shape_.columns; }
  std::uint32_t first(std::uint32_t symbol) const {
    return is_object(symbol) ? symbol : clusters_[symbol - shape_.columns].first;
  }
  std::uint32_t reach(std::uint32_t symbol) const {
    return is_object(symbol) ? symbol + 1 : clusters_[symbol - shape_.columns].reach;
  }
  /// 0 for an object.
  std::uint32_t rank(std::uint32_t symbol) const {
    return is_object(symbol) ? 0 : clusters_[symbol - shape_.columns].rank;
  }
  /// Some row that has the symbol's cluster: what stands near in the matrix is alike.
  std::uint32_t row_near(std::uint32_t list) const {
    return is_row(list) ? list : clusters_[list - shape_.rows].near;
  }
  const PannePrices& prices() const { return prices_; }
  /// How many ranks are given away at a column.
  std::uint32_t heads(std::uint32_t column) const { return heads_[column]; }
  /// The whole price, in 1/1024 bit. What share, join, dissolve and settle do
  /// makes it less, or they change nothing.
  std::uint64_t price() const { return price_; }
  /// The same, computed anew. O(symbols).
  std::uint64_t price_of_all() const;

  /// Each group of equal columns, seen from two rows or more, becomes a cluster, of a table without any; prices by what numbers
  /// there are then. That may cost something. False if there is no group.
  bool group_equal_columns(const VisibilityMatrix& matrix);

  /// Lists a and b share a subset, which becomes a cluster, or is one already. How much is saved, at most 0 if nothing; `common`
  /// gets the subset. Thread-safe. O(symbols of both).
  std::int64_t saved_by_sharing(std::uint32_t a, std::uint32_t b, List& common) const;
  bool share(std::uint32_t a, std::uint32_t b);

  /// Symbols x and y, x beginning first, become a cluster in those of `both`, ascending lists that hold both, where this saves.
  std::int64_t saved_by_joining(std::uint32_t x, std::uint32_t y, std::span<const std::uint32_t> both) const;
  bool join(std::uint32_t x, std::uint32_t y, std::span<const std::uint32_t> both);

  /// Clusters that stand in a single list go back into it where this saves, and those in none vanish. How many went.
  std::uint32_t dissolve();

  /// Clusters of symbols for which chosen[symbol - columns] is set go back into the lists that hold them, where lists behind would
  /// not notice. For a search that is stuck: it costs something.
  void loosen(const std::vector<bool>& chosen);

  /// Ranks by how often clusters stand in lists, prices by what numbers there are.
  bool settle();

  /// Ranks without the holes that clusters left that are no more. Not for a search that goes on: prices stay.
  void close_ranks();

  /// The objects of a list, ascending.
  List expand(std::uint32_t list) const;

  /// Each number that tells a list, in turn: visit(kind, number). An end is a 1.
  template <typename Visit>
  void for_each_number(std::uint32_t list, const Visit& visit) const {
    const List& symbols = lists_[list];
    if (symbols.empty()) return;
    std::size_t i = 0;
    std::uint32_t from = 0;
    if (!is_row(list)) {
      visit(PanneNumber::lead, rank(symbols[0]) + 1);
      from = reach(symbols[i++]);
    }
    while (i < symbols.size()) {
      const std::uint32_t symbol = symbols[i++], zeros = first(symbol) - from;
      from = reach(symbol);
      if (!is_object(symbol)) {
        visit(PanneNumber::cluster_step, zeros + 1);
        visit(PanneNumber::rank, rank(symbol));
        continue;
      }
      for (; i < symbols.size() && symbols[i] == from; ++i) ++from;
      visit(from - symbol == 1 ? PanneNumber::object_step : PanneNumber::run_step, zeros + 1);
      if (from - symbol > 1) visit(PanneNumber::run, from - symbol - 1);
    }
    visit(PanneNumber::end, 1);
  }

 private:
  struct Cluster {
    std::uint32_t first, reach, rank, near;
  };
  struct NewCluster {
    std::uint32_t first, reach, rank;
  };
  struct Joined {
    NewCluster cluster;
    bool exists;  // as that of `symbol`
    std::uint32_t symbol;
  };
  class Pricer;
  std::uint64_t list_price(std::span<const std::uint32_t> list, bool row) const;
  std::uint64_t head_price(std::uint32_t first) const;
  std::uint32_t reach_of(std::span<const std::uint32_t> list) const;
  void keep_reach(std::uint32_t list, List& common) const;
  std::uint32_t add(List list, std::uint32_t near);
  Joined joined(std::uint32_t x, std::uint32_t y, std::span<const std::uint32_t> both) const;
  std::int64_t saved_in(std::uint32_t list, std::uint32_t x, std::uint32_t y,
                        const NewCluster& cluster) const;
  std::size_t place_of(std::uint32_t list, std::uint32_t symbol) const;
  bool follows(const List& list, std::size_t place) const;
  PannePrices::Counts counts() const;

  Shape shape_;
  std::vector<List> lists_;
  std::vector<Cluster> clusters_;
  std::vector<std::uint32_t> heads_;  // ranks given away at each column
  PannePrices prices_;
  std::uint64_t price_ = 0;
};

}  // namespace vismat
