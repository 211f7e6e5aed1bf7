#include "matrix/partition.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "matrix/base/random.h"

namespace vismat {

Partition Partition::identity(std::uint32_t size) {
  Partition alone;
  alone.group_of_member_.resize(size);
  std::iota(alone.group_of_member_.begin(), alone.group_of_member_.end(), 0u);
  alone.groups_ = size;
  return alone;
}

Partition Partition::from_group_of_member(std::vector<std::uint32_t> map) {
  Partition partition;
  std::vector<bool> met(map.size(), false);
  for (const std::uint32_t group : map) {
    if (group >= map.size()) {
      throw std::invalid_argument("group " + std::to_string(group) + " of " + std::to_string(map.size()) +
                                  " members; there are at most as many groups as members");
    }
    met[group] = true;
    partition.groups_ = std::max(partition.groups_, group + 1);
  }
  const auto empty = std::find(met.begin(), met.begin() + partition.groups_, false) - met.begin();
  if (empty < partition.groups_)
    throw std::invalid_argument("group " + std::to_string(empty) + " has no member");
  partition.group_of_member_ = std::move(map);
  return partition;
}

VisibilityMatrix Partition::members() const {
  std::vector<std::uint64_t> offsets(size() + std::size_t{1});
  std::iota(offsets.begin(), offsets.end(), std::uint64_t{0});
  return transpose(VisibilityMatrix::from_csr({size(), groups_}, std::move(offsets), group_of_member_));
}

Partition followed_by(const Partition& first, const Partition& then) {
  assert(first.groups() == then.size());
  std::vector<std::uint32_t> map(first.group_of_member().begin(), first.group_of_member().end());
  for (std::uint32_t& group : map) group = then.group_of_member()[group];
  return Partition::from_group_of_member(std::move(map));
}

Partition renumbered(const Partition& groups, const Permutation& order) {
  assert(groups.groups() == order.size());
  std::vector<std::uint32_t> map(groups.group_of_member().begin(), groups.group_of_member().end());
  for (std::uint32_t& group : map) group = order.new_of_old()[group];
  return Partition::from_group_of_member(std::move(map));
}

Partition equal_rows(const VisibilityMatrix& matrix) {
  std::unordered_multimap<std::uint64_t, std::uint32_t> met;  // rows by hash
  std::vector<std::uint32_t> kind(matrix.shape().rows);
  std::uint32_t kinds = 0;
  for (std::uint32_t r = 0; r < kind.size(); ++r) {
    const auto ids = matrix.row(r);
    std::uint64_t hash = ids.size();
    for (const std::uint32_t id : ids) hash = Random(hash ^ id).next();
    const auto [begin, end] = met.equal_range(hash);
    const auto same = std::find_if(
        begin, end, [&](const auto& entry) { return std::ranges::equal(matrix.row(entry.second), ids); });
    kind[r] = same == end ? kinds++ : kind[same->second];
    if (same == end) met.emplace(hash, r);
  }
  return Partition::from_group_of_member(std::move(kind));
}

VisibilityMatrix merge_rows(const VisibilityMatrix& matrix, const Partition& rows) {
  assert(rows.size() == matrix.shape().rows);
  const VisibilityMatrix members = rows.members();
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(rows.groups() + std::size_t{1});
  std::vector<std::uint32_t> ids;
  std::vector<std::uint32_t> last_group(matrix.shape().columns, rows.groups());  // that saw the column
  for (std::uint32_t g = 0; g < rows.groups(); ++g) {
    const auto begin = static_cast<std::ptrdiff_t>(ids.size());
    for (const std::uint32_t r : members.row(g)) {
      for (const std::uint32_t c : matrix.row(r)) {
        if (std::exchange(last_group[c], g) != g) ids.push_back(c);
      }
    }
    if (members.row(g).size() > 1) std::sort(ids.begin() + begin, ids.end());
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr({rows.groups(), matrix.shape().columns}, std::move(offsets),
                                    std::move(ids));
}

VisibilityMatrix merge_columns(const VisibilityMatrix& matrix, const Partition& columns) {
  return transpose(merge_rows(transpose(matrix), columns));
}

VisibilityMatrix expand_rows(const VisibilityMatrix& merged, const Partition& rows) {
  assert(rows.groups() == merged.shape().rows);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(rows.size() + std::size_t{1});
  for (const std::uint32_t g : rows.group_of_member())
    offsets.push_back(offsets.back() + merged.row(g).size());
  std::vector<std::uint32_t> ids;
  ids.reserve(offsets.back());
  for (const std::uint32_t g : rows.group_of_member())
    ids.insert(ids.end(), merged.row(g).begin(), merged.row(g).end());
  return VisibilityMatrix::from_csr({rows.size(), merged.shape().columns}, std::move(offsets),
                                    std::move(ids));
}

VisibilityMatrix expand_columns(const VisibilityMatrix& merged, const Partition& columns) {
  return transpose(expand_rows(transpose(merged), columns));
}

}  // namespace vismat
