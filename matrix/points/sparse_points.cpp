// ALGORITHM. Finding equal columns. Columns are sorted by a 64-bit hash of their ids. Columns with equal hashes are
// compared with the first of each kind among them, so a collision of hashes costs time and never merges columns that
// differ.
#include "matrix/points/sparse_points.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "matrix/base/parallel.h"

namespace vismat {
namespace {

constexpr std::uint32_t none = 0xffffffff;

std::uint64_t hash(std::span<const std::uint32_t> ids) {
  std::uint64_t h = ids.size();
  for (const std::uint32_t id : ids) {
    h = (h ^ id) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  }
  return h;
}

}  // namespace

SparsePoints::SparsePoints(Shape shape, VisibilityMatrix transposed)
    : shape_(shape),
      in_memory_(std::move(transposed)),
      column_of_point_(shape.columns),
      twin_(shape.columns, none) {
  std::iota(column_of_point_.begin(), column_of_point_.end(), 0u);
}

SparsePoints::SparsePoints(const VisibilityMatrix& matrix, bool collapse)
    : SparsePoints(matrix.shape(), transpose(matrix)) {
  if (collapse) find_points();
}

SparsePoints SparsePoints::of_rows(VisibilityMatrix rows) {
  const Shape shape{rows.shape().columns, rows.shape().rows};
  return {shape, std::move(rows)};
}

SparsePoints::SparsePoints(const VisibilityMatrix& matrix, const std::filesystem::path& folder,
                           std::uint64_t buffer_bytes)
    : shape_(matrix.shape()), on_disk_(folder), offsets_(std::size_t{shape_.columns} + 1, 0) {
  for (std::uint32_t r = 0; r < shape_.rows; ++r) {
    for (const std::uint32_t c : matrix.row(r)) ++offsets_[c + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  std::vector<std::uint32_t> ids;
  std::vector<std::uint64_t> next;
  for (std::uint32_t first = 0, end; first < shape_.columns; first = end) {
    const auto after = std::upper_bound(offsets_.begin() + first + 1, offsets_.end(),
                                        offsets_[first] + buffer_bytes / sizeof ids[0]);
    end = std::max(first + 1, static_cast<std::uint32_t>(after - offsets_.begin()) - 1);
    ids.resize(offsets_[end] - offsets_[first]);
    next.assign(offsets_.begin() + first, offsets_.begin() + end);
    for (std::uint32_t r = 0; r < shape_.rows; ++r) {
      const auto row = matrix.row(r);
      for (auto c = std::lower_bound(row.begin(), row.end(), first); c != row.end() && *c < end; ++c)
        ids[next[*c - first]++ - offsets_[first]] = r;
    }
    on_disk_.append(ids);
  }
  on_disk_.map();
  find_points();
}

// Which columns are equal, which are empty.
void SparsePoints::find_points() {
  const std::uint32_t count = shape_.columns;
  twin_.assign(count, none);
  column_of_point_.clear();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  for (std::uint32_t c = 0; c < count; ++c) {
    if (of_column(c).empty())
      empty_.push_back(c);
    else
      keys.emplace_back(hash(of_column(c)), c);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> last;  // of each kind among equal hashes, the column found last
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i].first != keys[i - 1].first) last.clear();
    const std::uint32_t c = keys[i].second;
    const auto same = std::find_if(last.begin(), last.end(), [&](std::uint32_t other) {
      const auto a = of_column(c), b = of_column(other);
      return std::equal(a.begin(), a.end(), b.begin(), b.end());
    });
    if (same == last.end()) {
      last.push_back(c);
      column_of_point_.push_back(c);
    } else {
      twin_[*same] = c;
      *same = c;
    }
  }
  std::sort(column_of_point_.begin(), column_of_point_.end());
}

std::uint32_t SparsePoints::distance(std::uint32_t a, std::uint32_t b) const {
  const auto x = ones(a), y = ones(b);
  std::uint32_t shared = 0;
  for (std::size_t i = 0, j = 0; i < x.size() && j < y.size();) {  // without a branch to mispredict
    const std::uint32_t u = x[i], v = y[j];
    shared += u == v;
    i += u <= v;
    j += v <= u;
  }
  return static_cast<std::uint32_t>(x.size() + y.size()) - 2 * shared;
}

Permutation SparsePoints::order_of_columns(std::span<const std::uint32_t> points) const {
  std::vector<std::uint32_t> order;
  order.reserve(shape_.columns);
  for (const std::uint32_t p : points) {
    for (std::uint32_t c = column_of_point_[p]; c != none; c = twin_[c]) order.push_back(c);
  }
  order.insert(order.end(), empty_.begin(), empty_.end());
  return Permutation::from_old_of_new(std::move(order));
}

std::vector<std::uint32_t> SparsePoints::visits_of_order(const Permutation& order) const {
  std::vector<std::uint32_t> point_of_column(shape_.columns, none), visits;
  for (std::uint32_t p = 0; p < size(); ++p) point_of_column[column_of_point_[p]] = p;
  visits.reserve(size());
  for (const std::uint32_t c : order.old_of_new()) {
    if (point_of_column[c] != none) visits.push_back(point_of_column[c]);
  }
  return visits;
}

std::uint64_t runs_of_visits(const SparsePoints& points, std::span<const std::uint32_t> visits,
                             unsigned threads) {
  if (visits.empty()) return 0;
  std::atomic<std::uint64_t> length =
      points.weight(visits.front()) + std::uint64_t{points.weight(visits.back())};
  constexpr std::size_t piece = 4096;
  parallel_for((visits.size() + piece - 2) / piece, threads, [&](std::uint64_t n) {
    std::uint64_t sum = 0;
    const std::size_t end = std::min(visits.size(), (n + 1) * piece + 1);
    for (std::size_t i = n * piece + 1; i < end; ++i) sum += points.distance(visits[i - 1], visits[i]);
    length += sum;
  });
  return length / 2;
}

}  // namespace vismat
