// Disk reads against a bitmap of pages and a memory that is searched from end to end.
#include "runtime/disk_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> every_row(const VisibilityMatrix& m) {
  std::vector<std::uint32_t> rows(m.shape().rows);
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

// One fetch: marks every page that an object touches, then reads along.
void slow_fetch(const std::vector<std::uint64_t>& bytes, const std::vector<std::uint64_t>& offsets,
                const std::vector<std::uint32_t>& objects, const DiskOptions& options, DiskReads& count) {
  std::uint64_t total = 0;
  for (std::size_t o = 0; o < bytes.size(); ++o) total = std::max(total, offsets[o] + bytes[o]);
  std::vector<bool> wanted(total / options.page_bytes + 1, false);
  for (const std::uint32_t o : objects) {
    count.bytes_wanted += bytes[o];
    for (std::uint64_t at = offsets[o]; at < offsets[o] + bytes[o]; ++at)
      wanted[at / options.page_bytes] = true;
  }
  std::int64_t last = -1;
  for (std::int64_t page = 0; page < static_cast<std::int64_t>(wanted.size()); ++page) {
    if (!wanted[page]) continue;
    const bool goes_on = last >= 0 && page - last - 1 <= static_cast<std::int64_t>(options.read_ahead_pages);
    if (!goes_on) ++count.reads;
    count.bytes_read += options.page_bytes * static_cast<std::uint64_t>(goes_on ? page - last : 1);
    last = page;
  }
}

DiskReads slow_reads(const std::vector<std::uint64_t>& bytes, const Permutation& order,
                     const VisibilityMatrix& visible, const std::vector<std::uint32_t>& walk,
                     const DiskOptions& options) {
  std::vector<std::uint64_t> offsets(bytes.size());
  std::uint64_t end = 0;
  for (const std::uint32_t o : order.old_of_new()) {
    offsets[o] = end;
    end += bytes[o];
  }
  DiskReads count;
  std::map<std::uint32_t, std::size_t> memory;  // object: the step it was last in view
  for (std::size_t step = 0; step < walk.size(); ++step) {
    if (!options.cache_bytes) memory.clear();
    std::vector<std::uint32_t> fetched;
    for (const std::uint32_t o : visible.row(walk[step])) {
      if (!memory.contains(o)) fetched.push_back(o);
      memory[o] = step;
    }
    slow_fetch(bytes, offsets, fetched, options, count);
    while (options.cache_bytes) {
      std::uint64_t held = 0;
      for (const auto& [o, seen] : memory) held += bytes[o];
      const auto oldest = std::ranges::min_element(memory, {}, [](const auto& m) { return m.second; });
      if (held <= *options.cache_bytes || oldest->second == step) break;
      memory.erase(oldest);
    }
  }
  return count;
}

TEST(DiskReads, EqualThePageBitmaps) {
  for (const auto& m : test::assorted_matrices()) {
    Random random(m.matrix.ones());
    std::vector<std::uint64_t> bytes(m.matrix.shape().columns);
    for (auto& b : bytes) b = random.below(3) == 0 ? 0 : random.below(random.below(5) == 0 ? 200 : 20);
    const Permutation order = random_order(m.matrix.shape().columns, 4);
    std::vector<std::uint32_t> walk;
    for (int step = 0; step < 25 && m.matrix.shape().rows > 0; ++step)
      walk.push_back(random.below(m.matrix.shape().rows));
    for (const std::uint64_t page : {1, 7, 64}) {
      for (const std::uint64_t ahead : {0, 1, 5}) {
        for (const std::optional<std::uint64_t> cache :
             {std::optional<std::uint64_t>{}, {0}, {150}, {1000}, {100000}}) {
          const DiskOptions options{page, ahead, cache};
          EXPECT_EQ(count_disk_reads(DiskLayout(bytes, order), m.matrix, walk, options),
                    slow_reads(bytes, order, m.matrix, walk, options))
              << m.name << ", pages of " << page << ", ahead " << ahead << ", cache "
              << (cache ? std::to_string(*cache) : "none");
        }
      }
    }
  }
}

TEST(DiskReads, OfSinglePagesAreRunsOfOnes) {
  for (const auto& m : test::assorted_matrices()) {
    const std::uint32_t columns = m.matrix.shape().columns;
    const Permutation order = random_order(columns, 9);
    const auto reordered = permute(m.matrix, Permutation::identity(m.matrix.shape().rows), order);
    for (const std::uint64_t page : {1, 4096}) {
      const DiskLayout layout(std::vector<std::uint64_t>(columns, page), order);
      const DiskReads count = count_disk_reads(layout, m.matrix, every_row(m.matrix), {.page_bytes = page});
      EXPECT_EQ(count.reads, count_runs(reordered)) << m.name;
      EXPECT_EQ(count.bytes_read, page * m.matrix.ones()) << m.name;
      EXPECT_EQ(count.bytes_wanted, count.bytes_read) << m.name;
    }
  }
}

TEST(DiskReads, MemoryKeepsWhatIsInViewAndThenTheLastSeen) {
  const auto m = VisibilityMatrix::from_rows({{0, 1}, {2}, {3}, {0}, {1}}, 4);
  const DiskLayout layout({10, 10, 10, 10}, Permutation::identity(4));
  const std::vector<std::uint32_t> walk = {0, 1, 2, 3, 4};
  const auto wanted = [&](std::optional<std::uint64_t> cache) {
    return count_disk_reads(layout, m, walk, {.page_bytes = 10, .cache_bytes = cache}).bytes_wanted;
  };
  EXPECT_EQ(wanted({}), 60u);
  EXPECT_EQ(wanted(0), 60u);
  EXPECT_EQ(wanted(30), 60u);  // {2} {3} push 0 out, being the first of those seen alike; 0 pushes out 1
  EXPECT_EQ(wanted(40), 40u);
  const std::vector<std::uint32_t> standing(1000, 0);
  EXPECT_EQ(count_disk_reads(layout, m, standing, {.cache_bytes = 0}).bytes_wanted, 20u);
}

TEST(DiskReads, OfSizesBeyond32Bits) {
  const std::uint64_t big = 5'000'000'000;
  const auto m = VisibilityMatrix::from_rows({{0, 2}, {1}}, 3);
  const DiskLayout layout({big, 2 * big, big}, Permutation::from_old_of_new({2, 1, 0}));
  EXPECT_EQ(layout.offset(0), 3 * big);
  EXPECT_EQ(layout.total_bytes(), 4 * big);
  const std::vector<std::uint32_t> walk = {0, 1};
  EXPECT_EQ(count_disk_reads(layout, m, walk, {.page_bytes = 1}), (DiskReads{3, 4 * big, 4 * big}));
  EXPECT_EQ(count_disk_reads(layout, m, walk, {.page_bytes = 1, .read_ahead_pages = 2 * big}),
            (DiskReads{2, 6 * big, 4 * big}));
  EXPECT_EQ(count_disk_reads(layout, m, walk, {.page_bytes = 100 * big}), (DiskReads{2, 200 * big, 4 * big}));
}

TEST(DiskReads, OfNothing) {
  const VisibilityMatrix m = VisibilityMatrix::from_rows({{}, {0, 1}}, 2);
  const DiskLayout layout({0, 0}, Permutation::identity(2));
  EXPECT_EQ(count_disk_reads(layout, m, every_row(m)), DiskReads{});
  EXPECT_EQ(count_disk_reads(layout, m, {}), DiskReads{});
  const VisibilityMatrix none(Shape{3, 0});
  EXPECT_EQ(count_disk_reads(DiskLayout({}, Permutation{}), none, every_row(none), {.cache_bytes = 5}),
            DiskReads{});
}

TEST(DiskReads, RefuseWhatDoesNotGoTogether) {
  const VisibilityMatrix m(Shape{2, 3});
  const std::uint32_t rows[] = {0, 2};
  EXPECT_THROW(DiskLayout({1, 2}, Permutation::identity(3)), std::invalid_argument);
  EXPECT_THROW(DiskLayout({1ull << 63, 1ull << 63}, Permutation::identity(2)), std::invalid_argument);
  EXPECT_THROW(count_disk_reads(DiskLayout({1, 2}, Permutation::identity(2)), m, {}), std::invalid_argument);
  const DiskLayout layout({1, 2, 3}, Permutation::identity(3));
  EXPECT_THROW(count_disk_reads(layout, m, rows), std::invalid_argument);
  EXPECT_THROW(count_disk_reads(layout, m, {}, {.page_bytes = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
