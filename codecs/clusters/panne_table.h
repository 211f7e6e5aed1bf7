// A visibility matrix whose common subsets are factored out [van de Panne & Stewart 1999], with the price of coding it.
//
// A member is an object (a column) or a cluster. A cluster is two or more members that several lists have in common. A
// list is a row or the content of a cluster; the objects of its members do not overlap. In the graph of rows and
// columns, a set R of rows that all see a set C of columns has |R| + |C| edges through a cluster instead of |R| |C|.
//
// A member begins at its lowest object, its first, and reaches as far as its objects are known to follow one another
// without a gap. An object reaches the column behind it; a cluster reaches through its members in order, for as long as
// each begins where the one before reaches. No two members of a list begin at the same column. So a list is coded as
//
//   step     for each cluster and each maximal run of objects: the zeros from the column that the step before reaches (0 at first)
//            to its beginning, and its kind: a single object, a longer run or a cluster; then
//   run      the number of objects less one, or
//   rank     which of the clusters that begin there, from 1 on
//   lead     in place of a cluster's first step, whose beginning is known: its first member's rank, 0 for an object
//   end      behind the last step; a row without steps has no bits
//   heads    and once for each column: the number of clusters that begin there
//
// None of this changes in other lists when a cluster is added. Each number is one of the 168 symbols of
// run_length_symbols.h and raw bits. The price of a symbol is -log2 of its share of all numbers of its kind, in 1/1024
// bit. Only settle() changes the prices, so the lists that a change touches say exactly what it saves.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/clusters/panne_prices.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

class PanneTable {
 public:
  using List = std::vector<std::uint32_t>;
  static constexpr std::uint32_t most_columns = 1u << 24;  // what may have clusters

  /// The table without clusters.
  explicit PanneTable(const VisibilityMatrix& matrix);

  Shape shape() const { return shape_; }
  std::uint32_t clusters() const { return static_cast<std::uint32_t>(clusters_.size()); }
  /// The rows 0, 1, ..., and behind them the clusters. Cluster member s is list rows + s - columns. The list of a
  /// cluster that no longer exists is empty.
  std::span<const List> lists() const { return lists_; }
  bool is_row(std::uint32_t list) const { return list < shape_.rows; }
  std::uint32_t member_of_list(std::uint32_t list) const { return list - shape_.rows + shape_.columns; }
  std::uint32_t list_of_member(std::uint32_t member) const { return member - shape_.columns + shape_.rows; }
  bool is_object(std::uint32_t member) const { return member < shape_.columns; }
  std::uint32_t first(std::uint32_t member) const {
    return is_object(member) ? member : clusters_[member - shape_.columns].first;
  }
  std::uint32_t reach(std::uint32_t member) const {
    return is_object(member) ? member + 1 : clusters_[member - shape_.columns].reach;
  }
  /// Which of the members that begin at its column it is; 0 for an object.
  std::uint32_t rank(std::uint32_t member) const {
    return is_object(member) ? 0 : clusters_[member - shape_.columns].rank;
  }
  /// Some row that has the cluster of this list; lists with near rows are often alike.
  std::uint32_t row_near(std::uint32_t list) const {
    return is_row(list) ? list : clusters_[list - shape_.rows].near;
  }
  const PannePrices& prices() const { return prices_; }
  /// How many ranks have been given away at a column.
  std::uint32_t heads(std::uint32_t column) const { return heads_[column]; }
  /// The price of the whole table, in 1/1024 bit. share, join, dissolve and settle lower it or change nothing.
  std::uint64_t price() const { return price_; }
  /// The same price, computed anew. O(members).
  std::uint64_t price_of_all() const;

  /// Makes each group of equal columns that two rows or more see a cluster, in a table without clusters, and sets the
  /// prices by the numbers that the table then has. The price may rise. Returns false if there is no group.
  bool group_equal_columns(const VisibilityMatrix& matrix);

  /// What is saved if the subset that lists a and b have in common becomes a cluster (or is one already); at most 0 if
  /// nothing is. `common` gets the subset. Thread-safe. O(members of both).
  std::int64_t saved_by_sharing(std::uint32_t a, std::uint32_t b, List& common) const;
  bool share(std::uint32_t a, std::uint32_t b);

  /// What is saved if members x and y, of which x begins first, become a cluster in the lists of `both`, ascending,
  /// which hold both.
  std::int64_t saved_by_joining(std::uint32_t x, std::uint32_t y, std::span<const std::uint32_t> both) const;
  bool join(std::uint32_t x, std::uint32_t y, std::span<const std::uint32_t> both);

  /// Dissolves clusters that are in a single list where this saves, and removes those that are in none. Returns their
  /// number.
  std::uint32_t dissolve();

  /// Dissolves the clusters of members for which chosen[member - columns] is set, unless that would change the zeros
  /// that other lists count. For a search that is stuck: the price rises.
  void loosen(const std::vector<bool>& chosen);

  /// Ranks clusters by how often they are in lists, and sets the prices by the numbers that there are.
  bool settle();

  /// Closes the gaps that removed clusters left among the ranks. Only at the end of a search: prices stay as they are.
  void close_ranks();

  /// The objects of a list, ascending.
  List expand(std::uint32_t list) const;

  /// Calls visit(kind, number) for each number that codes a list, in turn. An end is a 1.
  template <typename Visit>
  void for_each_number(std::uint32_t list, const Visit& visit) const {
    const List& members = lists_[list];
    if (members.empty()) return;
    std::size_t i = 0;
    std::uint32_t from = 0;
    if (!is_row(list)) {
      visit(PanneNumber::lead, rank(members[0]) + 1);
      from = reach(members[i++]);
    }
    while (i < members.size()) {
      const std::uint32_t member = members[i++], zeros = first(member) - from;
      from = reach(member);
      if (!is_object(member)) {
        visit(PanneNumber::cluster_step, zeros + 1);
        visit(PanneNumber::rank, rank(member));
        continue;
      }
      for (; i < members.size() && members[i] == from; ++i) ++from;
      visit(from - member == 1 ? PanneNumber::object_step : PanneNumber::run_step, zeros + 1);
      if (from - member > 1) visit(PanneNumber::run, from - member - 1);
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
    bool exists;  // as that of `member`
    std::uint32_t member;
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
  std::size_t place_of(std::uint32_t list, std::uint32_t member) const;
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
