// ALGORITHM. A run end that the reference lacks must be told in full, one too many only costs a decision. So distances
// are not symmetric: 4 for the one, 1 for the other; against the number of columns in which rows differ this saves 6 to
// 8 % of the bytes. Candidates are the rows that differ in the fewest columns, by brute force, or, of many rows, those
// that stand near in one of several sorts by min-hash of their run ends.
#include "codecs/modelled/near_rows.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "matrix/base/parallel.h"
#include "matrix/base/random.h"
#include "matrix/bit_rows.h"

namespace vismat {

std::uint32_t reference_distance(Ends reference, Ends row) {
  const std::uint32_t *a = reference.at, *b = row.at;
  const std::uint32_t *const end_a = a + reference.count, *const end_b = b + row.count;
  std::uint32_t common = 0;
  while (a != end_a && b != end_b) {
    const std::uint32_t at_a = *a, at_b = *b;
    common += at_a == at_b;
    a += at_a <= at_b;
    b += at_b <= at_a;
  }
  return 4 * (row.count - common) + (reference.count - common);
}

namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;
using Names = std::vector<std::uint64_t>;
using Ranked = std::vector<std::tuple<std::uint32_t, std::uint64_t, std::uint32_t>>;  // distance, name, row

void keep_nearest(Ranked& ranked, std::size_t count) {
  count = std::min(count, ranked.size());
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  ranked.resize(count);
}

// Of the candidates, the `count` most promising references.
std::vector<std::uint32_t> best_of(const RowEnds& ends, std::uint32_t row, Ranked& candidates,
                                   std::size_t count) {
  for (auto& [distance, name, other] : candidates) distance = reference_distance(ends[other], ends[row]);
  keep_nearest(candidates, count);
  std::vector<std::uint32_t> best;
  for (const auto& [distance, name, other] : candidates) best.push_back(other);
  return best;
}

Lists by_brute_force(const VisibilityMatrix& matrix, const RowEnds& ends, const Names& names,
                     std::uint32_t count, unsigned threads) {
  const BitRows bits(matrix);
  Lists lists(ends.rows());
  parallel_for(ends.rows(), threads, [&](std::uint64_t i) {
    const auto row = static_cast<std::uint32_t>(i);
    Ranked ranked;
    for (std::uint32_t other = 0; other < ends.rows(); ++other) {
      if (other != row)
        ranked.emplace_back(hamming_distance(bits.row(row), bits.row(other)), names[other], other);
    }
    keep_nearest(ranked, 4 * std::size_t{count});
    lists[row] = best_of(ends, row, ranked, count);
  });
  return lists;
}

Lists by_min_hash(const RowEnds& ends, const Names& names, std::uint32_t count, unsigned threads) {
  constexpr std::uint32_t sorts = 12, window = 6;
  std::vector<std::vector<std::uint32_t>> order(sorts), place(sorts);
  parallel_for(sorts, threads, [&](std::uint64_t sort) {
    // Two min-hashes, so that rows in a tie are near as well.
    std::vector<std::array<std::uint64_t, 3>> least(ends.rows());
    for (std::uint32_t r = 0; r < ends.rows(); ++r) {
      least[r] = {~std::uint64_t{0}, ~std::uint64_t{0}, names[r]};
      for (std::uint32_t i = 0; i < ends[r].count; ++i) {
        for (std::uint64_t hash = 0; hash < 2; ++hash)
          least[r][hash] = std::min(least[r][hash], Random(2 * sort + hash, ends[r].at[i]).next());
      }
    }
    order[sort].resize(ends.rows());
    std::iota(order[sort].begin(), order[sort].end(), 0u);
    std::ranges::stable_sort(order[sort], {}, [&](std::uint32_t r) { return least[r]; });
    place[sort].resize(ends.rows());
    for (std::uint32_t i = 0; i < ends.rows(); ++i) place[sort][order[sort][i]] = i;
  });
  Lists lists(ends.rows());
  parallel_for(ends.rows(), threads, [&](std::uint64_t i) {
    const auto row = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> found;
    const auto look = [&](const std::vector<std::uint32_t>& rows, std::uint32_t at, std::uint32_t reach) {
      for (std::uint32_t j = at - std::min(at, reach);
           j <= std::min<std::uint64_t>(at + std::uint64_t{reach}, rows.size() - 1); ++j)
        found.push_back(rows[j]);
    };
    for (std::uint32_t sort = 0; sort < sorts; ++sort) look(order[sort], place[sort][row], window);
    std::ranges::sort(found);
    Ranked ranked;
    for (std::size_t j = 0; j < found.size(); ++j) {
      if (found[j] != row && (j == 0 || found[j] != found[j - 1]))
        ranked.emplace_back(0, names[found[j]], found[j]);
    }
    lists[row] = best_of(ends, row, ranked, count);
  });
  return lists;
}

}  // namespace

Lists near_rows(const VisibilityMatrix& matrix, const RowEnds& ends, const Names& names, std::uint32_t count,
                unsigned threads) {
  const std::uint64_t words = std::uint64_t{ends.rows()} * ends.rows() * ((ends.columns() + 63) / 64);
  constexpr std::uint64_t most = 2'000'000'000;  // some seconds
  return words <= most ? by_brute_force(matrix, ends, names, count, threads)
                       : by_min_hash(ends, names, count, threads);
}

}  // namespace vismat
