// A closed tour in an array, parts of which can be reversed.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace vismat {

/// The points in an array, and each point's place: next, prev and apart take O(1), exchange O(the shorter side).
class ArrayTour {
 public:
  /// A part of the tour, from one place to another, past the array's end and on from its beginning if need be.
  struct Way {
    std::uint32_t first, last;
  };

  explicit ArrayTour(std::vector<std::uint32_t> order) : order_(std::move(order)), place_(order_.size()) {
    for (std::uint32_t i = 0; i < size(); ++i) place_[order_[i]] = i;
  }
  std::uint32_t size() const { return static_cast<std::uint32_t>(order_.size()); }
  const std::vector<std::uint32_t>& order() const { return order_; }
  std::uint32_t at(std::uint32_t place) const { return order_[place]; }
  std::uint32_t next(std::uint32_t p) const { return order_[after(place_[p])]; }
  std::uint32_t prev(std::uint32_t p) const { return order_[before(place_[p])]; }
  /// The number of steps by next() from one point to another.
  std::uint32_t steps(std::uint32_t from, std::uint32_t to) const { return length(place_[from], place_[to]); }
  /// The number of steps between two points the shorter way around.
  std::uint32_t apart(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t onwards = steps(a, b);
    return std::min(onwards, size() - onwards);
  }

  /// Replaces edges a-b and c-d by a-c and b-d; in one direction of the tour, b follows a and d follows c. Reversing
  /// the returned part again undoes it.
  Way exchange(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const bool forward = next(a) == b;
    Way way{place_[forward ? b : a], place_[forward ? c : d]};
    if (2 * std::uint64_t{length(way.first, way.last)} + 2 > size())  // the rest reversed gives the same tour
      way = {after(way.last), before(way.first)};
    turn(way);
    return way;
  }
  void turn(Way way) {
    for (std::uint32_t swaps = (length(way.first, way.last) + 1) / 2; swaps > 0; --swaps) {
      std::swap(order_[way.first], order_[way.last]);
      place_[order_[way.first]] = way.first;
      place_[order_[way.last]] = way.last;
      way = {after(way.first), before(way.last)};
    }
  }

 private:
  std::uint32_t after(std::uint32_t place) const { return place + 1 == size() ? 0 : place + 1; }
  std::uint32_t before(std::uint32_t place) const { return (place == 0 ? size() : place) - 1; }
  std::uint32_t length(std::uint32_t first, std::uint32_t last) const {
    return last >= first ? last - first : last + size() - first;
  }
  std::vector<std::uint32_t> order_, place_;
};

}  // namespace vismat
