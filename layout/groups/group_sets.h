// The sets of columns of groups of rows that are being merged.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/bit_rows.h"
#include "matrix/points/inverted_index.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A set of columns for each group, the union of its rows; at first each row is a group, and a group keeps its number
/// when others join it. The sets are kept as bits, or as lists with an inverted index, from which one search learns
/// what a set has in common with all others. The results are the same. The rows must outlive it. Memory: rows * columns
/// / 8 bytes, or at most 8 for each one of the rows.
class GroupSets {
 public:
  enum class Form { bits, lists };
  /// What is estimated to take less time: lists for sparse rows, bits for dense ones.
  static Form cheaper(const VisibilityMatrix& rows);
  GroupSets(const VisibilityMatrix& rows, Form form);

  bool listed() const { return form_ == Form::lists; }
  /// While there is no index, sets join in a fraction of the time; common() and moves need it. Only if listed().
  void drop_index();
  void make_index();
  bool indexed() const { return indexed_; }
  std::uint32_t size(std::uint32_t group) const { return size_[group]; }
  /// How many columns only one of the two has, or some number above `limit` as soon as it is known to be above.
  std::uint32_t distance(std::uint32_t a, std::uint32_t b, std::uint32_t limit) const;
  /// The same for a set that is no group, as bits. Only if not listed().
  std::uint32_t distance(std::span<const std::uint64_t> bits, std::uint32_t group,
                         std::uint32_t limit) const {
    return hamming_distance(bits, bits_.row(group), limit);
  }
  /// For each group, by its slot(), how many of the columns it has. `Count` holds the number of columns. Long counts are
  /// shared by at most so many threads. Only if indexed().
  template <typename Count>
  std::vector<Count> common(std::span<const std::uint32_t> columns, unsigned threads = 1) const {
    const std::size_t parts = std::clamp<std::size_t>(additions(columns) / least_of_thread, 1, threads);
    std::vector<std::vector<Count>> counts(parts);
    parallel_for(parts, threads, [&](std::uint64_t part) {
      counts[part].assign(slots_, Count{0});
      const std::size_t first = part * columns.size() / parts, end = (part + 1) * columns.size() / parts;
      index_.count_common(columns.subspan(first, end - first), counts[part].data());
    });
    for (std::size_t part = 1; part < parts; ++part)
      std::ranges::transform(counts[0], counts[part], counts[0].begin(), std::plus<>());
    return std::move(counts[0]);
  }
  std::uint32_t slot(std::uint32_t group) const { return slot_[group]; }
  /// How many of the group's columns each of the others has: O(their columns). Only if listed().
  std::vector<std::uint32_t> common_with(std::uint32_t group, std::span<const std::uint32_t> others) const;
  /// A group's columns, ascending. Only if listed().
  std::span<const std::uint32_t> list(std::uint32_t group) const {
    return is_row_[group] ? rows_.row(group) : std::span<const std::uint32_t>(lists_[group]);
  }
  /// Is called for each column that only one of the two has, with whether it is the first of them.
  using Visit = std::function<void(std::uint32_t column, bool in_first)>;
  void each_difference(std::uint32_t a, std::uint32_t b, const Visit& visit) const;
  void each_difference(std::span<const std::uint32_t> columns, std::uint32_t group, const Visit& visit) const;

  /// `into` becomes the union of both; `from` is no longer used.
  void join(std::uint32_t into, std::uint32_t from);

  /// Begins and ends a time in which rows may move from group to group, and groups do not join. `alive` are the groups
  /// in use. Memory meanwhile: groups * columns * 4 bytes, or 4 for each column of each group.
  void begin_moves(std::span<const std::uint32_t> alive, std::span<const std::uint32_t> group_of_row);
  void end_moves();
  /// How many of the row's columns no other row of its group has.
  std::uint32_t alone(std::uint32_t row, std::uint32_t group) const;
  void move(std::uint32_t row, std::uint32_t from, std::uint32_t to);

 private:
  // To start a thread takes as long as some 30,000 additions.
  static constexpr std::size_t least_of_thread = 100000;
  std::size_t additions(std::span<const std::uint32_t> columns) const {
    std::size_t sum = 0;
    for (const std::uint32_t c : columns) sum += index_.sets_with(c).size();
    return sum;
  }
  void fold(std::uint32_t group);
  void close_gaps();
  void move_bits(std::uint32_t row, std::uint32_t from, std::uint32_t to);
  void move_list(std::uint32_t row, std::uint32_t from, std::uint32_t to);
  std::uint32_t* seen_by(std::uint32_t group) {
    return seen_.data() + std::size_t{place_[group]} * rows_.shape().columns;
  }

  const VisibilityMatrix& rows_;
  Form form_;
  std::vector<std::uint32_t> size_;
  // As bits; folded_ has each set's words folded by exclusive or into a cache line, whose distances are never larger.
  BitRows bits_, folded_;
  std::vector<std::uint32_t> seen_, place_;  // while rows move: by how many rows of a group, by its place
  // As lists, ascending. A group that is still a row has its list there.
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<bool> is_row_;
  std::vector<std::vector<std::uint32_t>>
      counts_;  // while rows move: of how many rows each column of a list is
  // Groups have other numbers in the index: without gaps, so that what is counted for them stays in the cache.
  std::vector<std::uint32_t> slot_;
  std::uint32_t slots_ = 0, used_slots_ = 0;
  InvertedIndex index_;
  bool indexed_ = false;
};

}  // namespace vismat
