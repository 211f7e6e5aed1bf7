// Clusters of common subsets: every step saves what it says, rows come back, hostile clusters are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/clusters/panne.h"
#include "codecs/rows/row_codec.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

using test::NamedMatrix;
using Bytes = std::vector<std::byte>;

std::vector<NamedMatrix> panne_matrices() {
  std::vector<NamedMatrix> all = test::assorted_matrices();
  std::vector<std::vector<std::uint32_t>> identity(80), nested(80), halves(60);
  for (std::uint32_t r = 0; r < 80; ++r) {
    identity[r] = {r};
    for (std::uint32_t c = 0; c < r; ++c) nested[r].push_back(c);
  }
  for (std::uint32_t r = 0; r < 60; ++r) {  // every second row another half, with a few of its own
    for (std::uint32_t c = r % 2; c < 200; c += 2) {
      if (c % 60 != r) halves[r].push_back(c);
    }
  }
  all.push_back({"identity", VisibilityMatrix::from_rows(identity, 80)});
  all.push_back({"nested rows", VisibilityMatrix::from_rows(nested, 80)});
  all.push_back({"two halves", VisibilityMatrix::from_rows(halves, 200)});
  all.push_back({"half dense", test::random_matrix({60, 120}, .5, 21)});
  all.push_back({"one row", test::random_matrix({1, 500}, .3, 22)});
  all.push_back({"one column", test::random_matrix({500, 1}, .3, 23)});
  all.push_back({"equal rows", VisibilityMatrix::from_rows(std::vector(40, nested[30]), 80)});
  all.push_back({"bands out of order", test::banded_matrix(300, 40, 7)});
  all.push_back({"wide gaps", test::clustered_matrix({60, 5000}, 24)});
  return all;
}

VisibilityMatrix expanded(const PanneTable& table) {
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t r = 0; r < table.shape().rows; ++r) rows.push_back(table.expand(r));
  return VisibilityMatrix::from_rows(rows, table.shape().columns);
}

// What a list costs is told by its numbers alone; the table's own sum has to be theirs.
std::uint64_t price_by_numbers(const PanneTable& table) {
  std::uint64_t price = 0;
  for (std::uint32_t l = 0; l < table.lists().size(); ++l) {
    table.for_each_number(
        l, [&](PanneNumber kind, std::uint32_t number) { price += table.prices().of(kind, number); });
  }
  for (std::uint32_t c = 0; c < table.shape().columns; ++c)
    price += table.prices().of(PanneNumber::heads, table.heads(c) + 1);
  return price;
}

TEST(PanneSearch, SavesWhatItSaysInEveryStep) {
  for (const NamedMatrix& m : panne_matrices()) {
    std::uint64_t before = PanneTable(m.matrix).price(), steps = 0;
    PanneSearch search;
    search.after_step = [&](const PanneTable& table) {
      ASSERT_LT(table.price(), before) << m.name << ", step " << steps;
      ASSERT_EQ(table.price(), price_by_numbers(table)) << m.name << ", step " << steps;
      if (steps % 50 == 0) {
        ASSERT_EQ(expanded(table), m.matrix) << m.name << ", step " << steps;
      }
      before = table.price();
      ++steps;
    };
    const PanneTable table = search_clusters(m.matrix, search);
    EXPECT_EQ(table.price(), before) << m.name;
    EXPECT_EQ(table.price(), table.price_of_all()) << m.name;
    EXPECT_EQ(expanded(table), m.matrix) << m.name;

    // What prices rest on: a cluster's symbols do not overlap, begin in ascending order, and reach as far as is told.
    for (std::uint32_t l = 0; l < table.lists().size(); ++l) {
      const auto& list = table.lists()[l];
      if (!table.is_row(l) && list.empty()) continue;
      if (!table.is_row(l)) {
        EXPECT_GE(list.size(), 2u) << m.name;
      }
      const auto objects = table.expand(l);
      EXPECT_EQ(std::adjacent_find(objects.begin(), objects.end()), objects.end()) << m.name;
      std::uint32_t reach = list.empty() ? 0 : table.first(list[0]);
      for (std::size_t i = 0; i < list.size(); ++i) {
        if (i > 0) {
          EXPECT_GE(table.first(list[i]), table.reach(list[i - 1])) << m.name;
        }
        if (table.first(list[i]) == reach) reach = table.reach(list[i]);
      }
      if (table.is_row(l)) continue;
      EXPECT_EQ(table.first(table.member_of_list(l)), objects[0]) << m.name;
      EXPECT_EQ(table.reach(table.member_of_list(l)), reach) << m.name;
    }
  }
}

TEST(PanneTable, SharesWhatTwoRowsHaveInCommon) {
  const auto matrix = test::clustered_matrix({30, 400}, 25);
  std::size_t shared = 0;
  for (std::uint32_t a = 0; a < 30; ++a) {
    for (std::uint32_t b = a + 1; b < 30; ++b) {
      std::vector<std::uint32_t> truth, common;
      std::ranges::set_intersection(matrix.row(a), matrix.row(b), std::back_inserter(truth));
      PanneTable table(matrix);
      const std::int64_t saved = table.saved_by_sharing(a, b, common);
      EXPECT_EQ(common, truth);
      const std::uint64_t before = table.price();
      EXPECT_EQ(table.share(a, b), saved > 0);
      EXPECT_EQ(before - table.price_of_all(), static_cast<std::uint64_t>(std::max<std::int64_t>(0, saved)));
      if (saved <= 0) continue;
      ++shared;
      EXPECT_EQ(table.expand(30), truth);
      EXPECT_EQ(expanded(table), matrix);
    }
  }
  EXPECT_GT(shared, 10u);
}

TEST(PanneTable, JoinsColumnsWhereThatSaves) {
  const auto matrix = test::random_matrix({250, 600}, .01, 26);
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t r = 0; r < 250; ++r) {  // columns 7 and 300 are seen together
    std::vector<std::uint32_t> row(matrix.row(r).begin(), matrix.row(r).end());
    std::erase(row, 7u);
    std::erase(row, 300u);
    if (r % 3 == 0) row.insert(row.end(), {7, 300});
    std::sort(row.begin(), row.end());
    rows.push_back(row);
  }
  const auto planted = VisibilityMatrix::from_rows(rows, 600);
  const VisibilityMatrix rows_of = transpose(planted);
  std::size_t joined = 0;
  for (const std::uint32_t x : {0u, 7u, 8u, 200u}) {
    for (std::uint32_t y = x + 1; y < 600; y += y == 301 ? 7 : 1) {
      std::vector<std::uint32_t> both;
      std::ranges::set_intersection(rows_of.row(x), rows_of.row(y), std::back_inserter(both));
      if (both.empty()) continue;
      PanneTable table(planted);
      const std::int64_t saved = table.saved_by_joining(x, y, both);
      const std::uint64_t before = table.price();
      EXPECT_EQ(table.join(x, y, both), saved > 0);
      EXPECT_EQ(before - table.price_of_all(), static_cast<std::uint64_t>(std::max<std::int64_t>(0, saved)));
      EXPECT_EQ(expanded(table), planted);
      joined += saved > 0;
      if (x == 7 && y == 300) {
        EXPECT_GT(saved, 0);
      }
    }
  }
  EXPECT_GE(joined, 1u);
}

TEST(PanneSearch, IsTheSameForAnyNumberOfThreads) {
  for (const auto& matrix :
       {test::clustered_matrix({200, 300}, 27), test::random_matrix({120, 200}, .1, 28)}) {
    const Encoded one = find_codec("panne").encode(matrix, {}, {.threads = 1});
    EXPECT_EQ(find_codec("panne").encode(matrix, {}, {.threads = 5}), one);
    EXPECT_EQ(find_codec("panne").encode(matrix, {}, {}), one);
  }
}

TEST(PanneSearch, IsATableWheneverTimeIsOver) {
  const auto matrix = test::clustered_matrix({400, 600}, 29);
  std::uint64_t before = PanneTable(matrix).price() + 1;
  for (const double seconds : {1e-9, .001, .05}) {
    const PanneTable table = search_clusters(matrix, {.seconds = seconds});
    EXPECT_EQ(expanded(table), matrix);
    EXPECT_LT(table.price(), before);
    before = PanneTable(matrix).price() + 1;
  }
}

TEST(Panne, TakesAboutItsPriceAndLessThanWithoutClusters) {
  const auto matrix = test::clustered_matrix({400, 700}, 30);
  const PanneTable plain(matrix), table = search_clusters(matrix, {});
  EXPECT_GT(table.clusters(), 10u);
  const auto bytes = [&](const PanneTable& t) {
    return static_cast<double>(encode_panne(matrix, t).payload.size());
  };
  const auto price = [](const PanneTable& t) { return static_cast<double>(t.price()) / 8192; };
  EXPECT_LT(bytes(table), bytes(plain));
  for (const PanneTable* t : {&plain, &table}) {
    EXPECT_GT(bytes(*t), price(*t) * .95);
    EXPECT_LT(bytes(*t), price(*t) * 1.05 + 400 + 300);  // a row's last byte; the codes
  }
}

TEST(Panne, HasNoClustersInVeryWideRows) {
  const std::uint32_t columns = PanneTable::most_columns + 1;
  std::vector<std::uint32_t> row;
  for (std::uint32_t c = 5; c < columns; c += 100000) row.push_back(c);
  const auto matrix = VisibilityMatrix::from_rows(std::vector(9, row), columns);
  EXPECT_EQ(search_clusters(matrix, {}).clusters(), 0u);
  const Encoded encoded = find_codec("panne").encode(matrix, {}, {});
  EXPECT_EQ(decode(find_codec("panne"), encoded, matrix.shape()), matrix);
}

// --- What no encoder makes ------------------------------------------------------------------------------------------------------

struct Step {
  std::uint32_t kind, zeros, count;
};
Step object(std::uint32_t zeros) {
  return {PanneCode::object, zeros, 1};
}
Step run(std::uint32_t zeros, std::uint32_t count) {
  return {PanneCode::run, zeros, count};
}
Step cluster(std::uint32_t zeros, std::uint32_t rank) {
  return {PanneCode::cluster, zeros, rank};
}
struct List {
  std::uint32_t lead;  // of a cluster
  std::vector<Step> steps;
};

// A payload by hand: how many clusters begin at each column, their lists in order, one row.
struct ByHand {
  Bytes payload;
  std::uint64_t model_bytes;
  std::uint32_t columns;
};
ByHand write_by_hand(const std::vector<std::uint32_t>& heads, const std::vector<List>& clusters,
                     const std::vector<Step>& row) {
  PanneCode steps(PanneCode::steps), runs, ranks, leads, head_code;
  const auto each = [&](const auto& visit, const std::vector<Step>& list) {
    for (const Step& step : list) {
      visit(steps, step.zeros + 1, step.kind);
      if (step.kind == PanneCode::run) visit(runs, step.count - 1, 0);
      if (step.kind == PanneCode::cluster) visit(ranks, step.count, 0);
    }
    visit(steps, 1, PanneCode::end);
  };
  const auto all_clusters = [&](const auto& visit) {
    for (const std::uint32_t head : heads) visit(head_code, head + 1, 0);
    for (const List& list : clusters) {
      visit(leads, list.lead + 1, 0);
      each(visit, list.steps);
    }
  };
  const auto count = [](PanneCode& code, std::uint32_t number, std::uint32_t kind) {
    code.count(number, kind);
  };
  all_clusters(count);
  each(count, row);
  Bytes payload;
  put_varint(payload, clusters.size());
  for (PanneCode* code : {&steps, &runs}) code->write(payload);
  if (!clusters.empty()) {
    for (PanneCode* code : {&ranks, &leads, &head_code}) code->write(payload);
  }
  BitWriter bits(payload);
  const auto put = [&](PanneCode& code, std::uint32_t number, std::uint32_t kind) {
    code.put(bits, number, kind);
  };
  if (!clusters.empty()) all_clusters(put);
  bits.flush();
  const std::uint64_t model_bytes = payload.size();
  each(put, row);
  bits.flush();
  return {std::move(payload), model_bytes, static_cast<std::uint32_t>(heads.size())};
}

VisibilityMatrix decode(const std::vector<std::uint32_t>& heads, const std::vector<List>& clusters,
                        const std::vector<Step>& row) {
  const ByHand file = write_by_hand(heads, clusters, row);
  const std::vector<std::uint64_t> starts = {file.model_bytes};
  return vismat::decode(find_codec("panne"), {file.payload, part_index_bytes(starts, file.payload.size())},
                        {1, file.columns});
}

std::vector<std::uint32_t> heads_at(std::uint32_t columns, std::initializer_list<std::uint32_t> at) {
  std::vector<std::uint32_t> heads(columns, 0);
  for (const std::uint32_t c : at) ++heads[c];
  return heads;
}

TEST(PanneDecoder, ReadsClustersByHand) {
  // 3 5 6 as cluster 1 at 3; with 8 as cluster 2 there; the row is 1, that, and 20 to 22
  const auto matrix = decode(heads_at(100, {3, 3}), {{0, {run(1, 2)}}, {1, {object(4)}}},
                             {object(1), cluster(1, 2), run(16, 3)});
  EXPECT_EQ(matrix, VisibilityMatrix::from_rows({{1, 3, 5, 6, 8, 20, 21, 22}}, 100));
}

// docs/vmat.md has these bytes.
TEST(PanneDecoder, ReadsThePagesClusters) {
  const ByHand file = write_by_hand(heads_at(24, {3, 3}), {{0, {run(1, 2)}}, {1, {object(4)}}},
                                    {object(1), cluster(1, 2), run(16, 3)});
  std::string hex;
  for (const std::byte byte : file.payload) {
    for (const unsigned half : {std::to_integer<unsigned>(byte) >> 4, std::to_integer<unsigned>(byte) & 15})
      hex += "0123456789abcdef"[half];
  }
  hex.insert(2 * file.model_bytes, " ");
  EXPECT_EQ(hex,
            "0200031003f0f0f0f0f0f0f0f0f0f03003d003f0f0f0f0f0f0f0f0f07002f0f0f0f0f0f0f0f0"
            "f0f0500211f0f0f0f0f0f0f0f0f0f0500001f0f0f0f0f0f0f0f0f0f05011f0f0f0f0f0f0f0f0"
            "f0f050010001f0f0f0f0f0f0f0f0f0f040080000c615 c10b");
}

TEST(PanneDecoder, RefusesWhatHoldsItself) {
  EXPECT_THROW(decode(heads_at(100, {3}), {{1, {object(1)}}}, {cluster(3, 1)}), FormatError);
  EXPECT_THROW(decode(heads_at(100, {3, 3}), {{2, {object(1)}}, {1, {object(1)}}}, {cluster(3, 1)}),
               FormatError);
}

TEST(PanneDecoder, RefusesAnObjectThatIsThereTwice) {
  // 3 and 9; 9 again as the row's own, as another cluster's, and as one's two
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {object(5)}}}, {cluster(3, 1), object(5)}), FormatError);
  EXPECT_THROW(
      decode(heads_at(100, {3, 4}), {{0, {object(5)}}, {0, {object(4)}}}, {cluster(3, 1), cluster(0, 1)}),
      FormatError);
  EXPECT_THROW(
      decode(heads_at(100, {2, 3, 4}),
             {{0, {cluster(0, 1), cluster(0, 1)}}, {0, {object(5)}}, {0, {object(4)}}}, {cluster(2, 1)}),
      FormatError);
}

// Each cluster holds the next two: the objects of the first would be as many as Fibonacci's numbers tell.
TEST(PanneDecoder, RefusesClustersThatGrowWithoutEnd) {
  const std::uint32_t columns = 200;
  std::vector<std::uint32_t> heads(columns, 0);
  std::vector<List> clusters;
  for (std::uint32_t c = 0; c < 190; ++c) {
    heads[c] = 1;
    if (c >= 188)
      clusters.push_back({0, {object(0)}});
    else
      clusters.push_back({0, {cluster(0, 1), cluster(0, 1)}});
  }
  EXPECT_THROW(decode(heads, clusters, {cluster(0, 1)}), FormatError);
}

TEST(PanneDecoder, RefusesWhatLiesOutside) {
  EXPECT_THROW(decode(heads_at(10, {}), {}, {object(10)}), FormatError);
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {object(96)}}}, {cluster(3, 1)}), FormatError);
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {run(5, 92)}}}, {cluster(3, 1)}), FormatError);
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {object(5)}}}, {cluster(3, 2)}), FormatError);  // no second
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {object(5)}}}, {cluster(4, 1)}), FormatError);  // none at 4
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {object(5)}}}, {object(98), run(0, 2)}), FormatError);
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {}}}, {object(98)}), FormatError);  // of one object
  EXPECT_THROW(decode(heads_at(100, {3}), {{0, {object(5)}}}, {}), FormatError);   // bits without a step
}

}  // namespace
}  // namespace vismat
