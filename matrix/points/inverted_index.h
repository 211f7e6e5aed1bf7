// An inverted index of sets, with which one set is compared to all others at once.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// For each id the sets that have it. What one set has in common with every other takes one addition for each two
/// occurrences of the same id. Memory: 4 bytes for each id of each set, and 12 for each id.
class InvertedIndex {
 public:
  /// Returns a set's ids, all below `ids`, without repeats.
  using IdsOf = std::function<std::span<const std::uint32_t>(std::uint32_t set)>;
  InvertedIndex() = default;
  InvertedIndex(std::uint32_t sets, std::uint32_t ids, const IdsOf& ids_of);
  /// With room for id i in room[i] sets, which must be no fewer than have it.
  InvertedIndex(std::uint32_t sets, std::span<const std::uint32_t> room, const IdsOf& ids_of);

  /// Ascending.
  std::span<const std::uint32_t> sets_with(std::uint32_t id) const {
    return std::span(sets_).subspan(first_[id], count_[id]);
  }
  /// Adds to common[s] the number of `ids` that set s has.
  template <typename Count>
  void count_common(std::span<const std::uint32_t> ids, Count* common) const {
    for (const std::uint32_t id : ids) {
      for (const std::uint32_t set : sets_with(id)) ++common[set];
    }
  }
  /// The set, which has the id, has it no more. O(log sets), and a move of what follows in the list.
  void erase(std::uint32_t id, std::uint32_t set);
  /// The set, which lacks the id, has it from now on. No id may be in more sets than it has room for: those that
  /// have it at the beginning, or what the constructor was told.
  void insert(std::uint32_t id, std::uint32_t set);
  /// The id goes from one set, which has it, to another, which lacks it. O(log sets), and a move of what lies between
  /// the two in the list.
  void give(std::uint32_t id, std::uint32_t from, std::uint32_t to);
  static constexpr std::uint32_t no_set = 0xffffffff;
  /// Set s becomes new_of_old[s], and loses its ids if that is no_set; the others must keep their order. O(ids of all
  /// sets).
  void renumber(std::span<const std::uint32_t> new_of_old);

 private:
  void fill(std::uint32_t sets, const IdsOf& ids_of);

  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> count_, sets_;
};

/// Estimated nanoseconds of processor time for comparing all pairs of `sets` sets, with an index and with bits, as
/// measured on a server of 2023. They depend on the sizes alone and so choose the same way on every machine.
struct AllPairsCost {
  double by_index = 0, by_bits = 0;
  double least() const { return by_index < by_bits ? by_index : by_bits; }
  /// Where distances above a limit may be left unknown, as in a search for the least, a third of the bits is read.
  bool index_beats_limited_bits() const { return by_index < by_bits / 3; }
};
/// `sets_with_id` has the number of sets for each id.
AllPairsCost all_pairs_cost(std::uint32_t sets, std::span<const std::uint32_t> sets_with_id);
/// Of the rows of a matrix.
AllPairsCost all_pairs_cost(const VisibilityMatrix& rows);

}  // namespace vismat
