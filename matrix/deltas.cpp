// The boundaries are sorted, so a single pass lists each under both of its cells in ascending order, and a cell's
// neighbours can be searched. There, outside comes after the last cell, as its number does.
#include "matrix/deltas.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "matrix/base/union_find.h"

namespace vismat {
namespace {

// Outside comes before all cells.
std::uint32_t rank(std::uint32_t cell) {
  return cell + 1;
}

[[noreturn]] void refuse(std::size_t boundary, const Boundary& b, const std::string& what) {
  throw std::invalid_argument("boundary " + std::to_string(boundary) + ", " + cell_name(b.from) + " to " +
                              cell_name(b.to) + ": " + what);
}

void check_order(std::span<const Boundary> boundaries) {
  const auto key = [](const Boundary& b) { return std::pair(rank(b.from), b.to); };
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    const Boundary& b = boundaries[i];
    if (b.to >= boundaries.size())
      refuse(i, b,
             "no more than " + std::to_string(boundaries.size()) +
                 " cells can be reached by as many boundaries");
    if (b.from != Boundary::outside && b.from >= b.to)
      refuse(i, b, "leads down; it must lead from the lesser cell up");
    if (i > 0 && key(boundaries[i - 1]) >= key(b))
      refuse(i, b, "must come before the one before it; those from outside come first, and all ascend");
  }
}

// Every cell once, behind the cell that it is entered from: part after part, each from outside.
std::vector<Boundary> ways_in(const BoundaryMap& map) {
  std::vector<bool> reached(map.cells(), false);
  std::vector<Boundary> ways;
  ways.reserve(map.cells());
  for (const std::uint32_t first : map.neighbours(Boundary::outside)) {
    const Boundary from_outside = {Boundary::outside, first};
    const auto boundary = map.crossing(Boundary::outside, first)->boundary;
    if (reached[first]) refuse(boundary, from_outside, "that part is entered from outside already");
    reached[first] = true;
    std::size_t next = ways.size();
    for (ways.push_back(from_outside); next < ways.size(); ++next) {
      const std::uint32_t cell = ways[next].to;
      if (cell < first)
        refuse(boundary, from_outside, "must enter that part at its least cell, " + std::to_string(cell));
      for (const std::uint32_t neighbour : map.neighbours(cell)) {
        if (neighbour == Boundary::outside || reached[neighbour]) continue;
        reached[neighbour] = true;
        ways.push_back({cell, neighbour});
      }
    }
  }
  const auto missed = std::find(reached.begin(), reached.end(), false);
  if (missed != reached.end())
    throw std::invalid_argument("no boundaries lead from outside to cell " +
                                std::to_string(missed - reached.begin()));
  return ways;
}

void check_neighbours(const VisibilityMatrix& neighbours, std::uint32_t rows) {
  const Shape shape = neighbours.shape();
  if (shape != Shape{rows, rows}) {
    throw std::invalid_argument("the neighbours are " + std::to_string(shape.rows) + " x " +
                                std::to_string(shape.columns) + ", but there are " + std::to_string(rows) +
                                " cells");
  }
  const VisibilityMatrix other = transpose(neighbours);
  for (std::uint32_t r = 0; r < rows; ++r) {
    if (!std::ranges::equal(neighbours.row(r), other.row(r)))
      throw std::invalid_argument("cell " + std::to_string(r) +
                                  " and its neighbours do not name one another");
  }
}

std::vector<Boundary> boundaries_between(const VisibilityMatrix& neighbours) {
  const std::uint32_t cells = neighbours.shape().rows;
  UnionFind joined(cells);  // a part's root is its least cell
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    for (const std::uint32_t neighbour : neighbours.row(cell)) joined.join_sets(cell, neighbour);
  }
  std::vector<Boundary> boundaries;
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    if (joined.find(cell) == cell) boundaries.push_back({Boundary::outside, cell});
  }
  for (std::uint32_t from = 0; from < cells; ++from) {
    for (const std::uint32_t to : neighbours.row(from)) {
      if (to > from) boundaries.push_back({from, to});
    }
  }
  if (boundaries.size() >= std::size_t{1} << 31)
    throw std::invalid_argument(std::to_string(boundaries.size()) + " boundaries; there can be 2^31 - 1");
  return boundaries;
}

// The first of the ascending ids that is not below `id`: in steps that double, as it is mostly near.
const std::uint32_t* first_not_below(const std::uint32_t* at, const std::uint32_t* end, std::uint32_t id) {
  std::ptrdiff_t step = 1;
  for (; step < end - at && at[step] < id; step *= 2) at += step;
  return std::lower_bound(at, at + std::min(step, end - at), id);
}

}  // namespace

std::string cell_name(std::uint32_t cell) {
  return cell == Boundary::outside ? "outside" : "cell " + std::to_string(cell);
}

void check_lists(const Deltas& deltas) {
  if (deltas.lists.shape().rows != 2 * std::uint64_t{deltas.boundaries.size()}) {
    throw std::invalid_argument(std::to_string(deltas.boundaries.size()) + " boundaries, but " +
                                std::to_string(deltas.lists.shape().rows) + " lists; each has two");
  }
}

Deltas deltas_of(const VisibilityMatrix& cells, const VisibilityMatrix& neighbours) {
  check_neighbours(neighbours, cells.shape().rows);
  Deltas deltas;
  deltas.boundaries = boundaries_between(neighbours);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(2 * deltas.boundaries.size() + 1);
  std::vector<std::uint32_t> ids;
  const auto list = [&](std::span<const std::uint32_t> in, std::span<const std::uint32_t> not_in) {
    std::ranges::set_difference(in, not_in, std::back_inserter(ids));
    offsets.push_back(ids.size());
  };
  for (const auto [from, to] : deltas.boundaries) {
    const auto before = from == Boundary::outside ? std::span<const std::uint32_t>{} : cells.row(from);
    list(cells.row(to), before);
    list(before, cells.row(to));
  }
  const auto lists = static_cast<std::uint32_t>(2 * deltas.boundaries.size());
  deltas.lists =
      VisibilityMatrix::from_csr({lists, cells.shape().columns}, std::move(offsets), std::move(ids));
  return deltas;
}

VisibilityMatrix cells_of(const Deltas& deltas) {
  check_lists(deltas);
  const BoundaryMap map(deltas.boundaries);
  const std::vector<Boundary> ways = ways_in(map);
  std::vector<std::uint64_t> offsets(std::size_t{map.cells()} + 1,
                                     0);  // at first, each row's size behind its place
  for (const auto [from, to] : ways) {
    const Crossing crossing = *map.crossing(from, to);
    const std::uint64_t most = (from == Boundary::outside ? 0 : offsets[std::size_t{from} + 1]) +
                               deltas.lists.row(crossing.appears()).size();
    const std::uint64_t vanishes = deltas.lists.row(crossing.vanishes()).size();
    if (vanishes > most) refuse(crossing.boundary, {from, to}, "more vanishes than was visible");
    offsets[std::size_t{to} + 1] = most - vanishes;
  }
  for (std::size_t r = 1; r < offsets.size(); ++r) offsets[r] += offsets[r - 1];

  std::vector<std::uint32_t> ids(offsets.back()), scratch;
  const auto row = [&](std::uint32_t cell) {
    if (cell == Boundary::outside) return std::span<std::uint32_t>{};
    return std::span(ids).subspan(offsets[cell], offsets[std::size_t{cell} + 1] - offsets[cell]);
  };
  const auto crossed = [&](std::uint32_t from, std::uint32_t to) {
    const Crossing crossing = *map.crossing(from, to);
    const auto appears = deltas.lists.row(crossing.appears());
    scratch.resize(row(from).size() + appears.size());
    try {
      scratch.resize(cross(row(from), appears, deltas.lists.row(crossing.vanishes()), scratch));
    } catch (const std::invalid_argument& error) {
      refuse(crossing.boundary, {from, to}, error.what());
    }
    return std::span<const std::uint32_t>(scratch);
  };
  for (const auto [from, to] : ways) std::ranges::copy(crossed(from, to), row(to).begin());
  for (std::size_t b = 0; b < deltas.boundaries.size(); ++b) {
    const auto [from, to] = deltas.boundaries[b];
    if (!std::ranges::equal(crossed(from, to), row(to)))
      refuse(b, deltas.boundaries[b], "another way leads to other ids visible there");
  }
  return VisibilityMatrix::from_csr({map.cells(), deltas.lists.shape().columns}, std::move(offsets),
                                    std::move(ids));
}

VisibilityMatrix neighbours_of(std::span<const Boundary> boundaries) {
  const BoundaryMap map(boundaries);
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> ids;
  for (std::uint32_t cell = 0; cell < map.cells(); ++cell) {
    std::ranges::copy_if(map.neighbours(cell), std::back_inserter(ids),
                         [](std::uint32_t neighbour) { return neighbour != Boundary::outside; });
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr({map.cells(), map.cells()}, std::move(offsets), std::move(ids));
}

BoundaryMap::BoundaryMap(std::span<const Boundary> boundaries) {
  check_order(boundaries);
  std::uint32_t cells = 0;
  for (const Boundary& b : boundaries) cells = std::max(cells, b.to + 1);
  begin_.assign(std::size_t{cells} + 2, 0);
  for (const auto [from, to] : boundaries) {
    ++begin_[place(from) + 1];
    ++begin_[place(to) + 1];
  }
  for (std::size_t p = 1; p < begin_.size(); ++p) begin_[p] += begin_[p - 1];
  neighbours_.resize(2 * boundaries.size());
  boundaries_.resize(2 * boundaries.size());
  std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
  const auto file = [&](std::uint32_t b) {
    const auto [from, to] = boundaries[b];
    for (const auto& [cell, neighbour] : {std::pair(from, to), std::pair(to, from)}) {
      const std::uint64_t at = next[place(cell)]++;
      neighbours_[at] = neighbour;
      boundaries_[at] = b;
    }
  };
  const auto first_inside = static_cast<std::uint32_t>(
      std::ranges::find_if(boundaries, [](const Boundary& b) { return b.from != Boundary::outside; }) -
      boundaries.begin());
  for (std::uint32_t b = first_inside; b < boundaries.size(); ++b) file(b);
  for (std::uint32_t b = 0; b < first_inside; ++b) file(b);
  ways_in(*this);
}

std::span<const std::uint32_t> BoundaryMap::neighbours(std::uint32_t cell) const {
  assert(cell < cells() || cell == Boundary::outside);
  const std::size_t p = place(cell);
  return {neighbours_.data() + begin_[p], static_cast<std::size_t>(begin_[p + 1] - begin_[p])};
}

std::optional<Crossing> BoundaryMap::crossing(std::uint32_t from, std::uint32_t to) const {
  if (from >= cells() && from != Boundary::outside) return std::nullopt;
  const auto near = neighbours(from);
  const auto found = std::ranges::lower_bound(near, to);
  if (found == near.end() || *found != to) return std::nullopt;
  const auto at = begin_[place(from)] + static_cast<std::uint64_t>(found - near.begin());
  return Crossing{boundaries_[at], rank(from) > rank(to)};
}

std::size_t cross(std::span<const std::uint32_t> visible, std::span<const std::uint32_t> appears,
                  std::span<const std::uint32_t> vanishes, std::span<std::uint32_t> result) {
  assert(result.size() >= visible.size() + appears.size());
  const std::uint32_t *at = visible.data(), *const end = at + visible.size();
  std::uint32_t* out = result.data();
  auto appear = appears.begin(), vanish = vanishes.begin();
  while (appear != appears.end() || vanish != vanishes.end()) {
    const bool adds = vanish == vanishes.end() || (appear != appears.end() && *appear <= *vanish);
    const std::uint32_t id = adds ? *appear++ : *vanish++;
    const std::uint32_t* const stop = first_not_below(at, end, id);
    out = std::copy(at, stop, out);
    at = stop;
    if (adds == (at != end && *at == id)) {
      throw std::invalid_argument(
          "column " + std::to_string(id) +
          (adds ? " appears, but was visible before" : " vanishes, but was not visible"));
    }
    if (adds) {
      *out++ = id;
    } else {
      ++at;
    }
  }
  return static_cast<std::size_t>(std::copy(at, end, out) - result.data());
}

}  // namespace vismat
