// Measures recall and time of FLANN's Hamming indexes against dimension and density, beside a scan of all columns.
//
// The columns are planted in groups of 25 on average. Each column is its group's centre, a random column of the given density,
// with every tenth one moved to another row. Equal columns count once, so sparse columns in few rows are fewer than asked for.
// Recall is the share of the k columns found that are no farther than the true k-th nearest. Times are of one thread, in processor
// seconds.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <flann/flann.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "layout/tours/flann_tour.h"
#include "matrix/base/random.h"
#include "matrix/bit_rows.h"
#include "matrix/points/distinct_columns.h"
#include "programs/csv.h"
#include "programs/measuring.h"

namespace vismat::bench {
namespace {

struct FlannRecallOptions {
  std::vector<std::uint32_t> rows = {256, 1024, 4096, 16384};
  std::vector<double> densities = {.002, .01, .05, .2};
  std::uint32_t columns = 10000, k = 10, queries = 100;
  std::uint64_t seed = 1;
  std::filesystem::path csv;
};

BitRows clustered_columns(std::uint32_t rows, double density, const FlannRecallOptions& options) {
  Random random(options.seed, rows + static_cast<std::uint64_t>(density * 1e6));
  const std::uint32_t clusters = std::max(1u, options.columns / 25);
  const auto ones = static_cast<std::uint32_t>(std::max(1., std::round(density * rows)));
  std::vector<std::vector<std::uint32_t>> centres(clusters);
  for (auto& centre : centres) {
    for (std::uint32_t i = 0; i < ones; ++i) centre.push_back(random.below(rows));
  }
  BitRows columns({options.columns, rows});
  for (std::uint32_t c = 0; c < options.columns; ++c) {
    for (const std::uint32_t row : centres[random.below(clusters)])
      columns.set(c, random.below(10) == 0 ? random.below(rows) : row);
  }
  return BitRows(transpose(distinct_columns(transpose(columns.to_matrix())).matrix));
}

// Distances of the k nearest others, ascending.
using Distances = std::vector<std::uint32_t>;

Distances scan(const BitRows& columns, std::uint32_t query, std::uint32_t k) {
  Distances nearest;  // a heap
  for (std::uint32_t p = 0; p < columns.shape().rows; ++p) {
    const std::uint32_t worst = nearest.size() < k ? 0xffffffff : nearest.front();
    const std::uint32_t d = p == query ? worst : hamming_distance(columns.row(query), columns.row(p), worst);
    if (p == query || (nearest.size() == k && d >= worst)) continue;
    if (nearest.size() == k) {
      std::pop_heap(nearest.begin(), nearest.end());
      nearest.pop_back();
    }
    nearest.push_back(d);
    std::push_heap(nearest.begin(), nearest.end());
  }
  std::sort_heap(nearest.begin(), nearest.end());
  return nearest;
}

struct RecallMeasured {
  double recall = 1, us_per_query = 0, build_seconds = 0;
};

using Hamming = flann::Hamming<unsigned char>;

RecallMeasured measure(BitRows& columns, const std::vector<Distances>& truth,
                       const flann::IndexParams& index_options, int checks, std::uint32_t k) {
  flann::Matrix<unsigned char> points(reinterpret_cast<unsigned char*>(columns.row(0).data()),
                                      columns.shape().rows, columns.words_per_row() * 8);
  RecallMeasured result;
  double start = processor_seconds();
  flann::Index<Hamming> index(points, index_options);
  index.buildIndex();
  result.build_seconds = processor_seconds() - start;

  const std::size_t queries = truth.size(), asked = std::size_t{k} + 1;
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> ids(queries * asked, none);
  std::vector<unsigned> distances(queries * asked);
  flann::Matrix<std::size_t> found(ids.data(), queries, asked);
  flann::Matrix<unsigned> found_distances(distances.data(), queries, asked);
  start = processor_seconds();
  index.knnSearch(flann::Matrix<unsigned char>(points.ptr(), queries, points.cols), found, found_distances,
                  asked, flann::SearchParams(checks));
  result.us_per_query = (processor_seconds() - start) * 1e6 / static_cast<double>(queries);
  std::uint64_t right = 0, all = 0;
  for (std::size_t q = 0; q < queries; ++q) {
    const std::size_t wanted = truth[q].size();
    std::size_t near = 0;
    for (std::size_t i = 0; i < asked; ++i)
      near += found[q][i] != none && found[q][i] != q && found_distances[q][i] <= truth[q].back();
    right += std::min(near, wanted);
    all += wanted;
  }
  result.recall = static_cast<double>(right) / static_cast<double>(all);
  return result;
}

// So many bits that a key tells as much as a column's number does, of those that FLANN can keep a table of.
unsigned sensible_key(double density, std::uint32_t columns) {
  const double entropy = -density * std::log2(density) - (1 - density) * std::log2(1 - density);
  return static_cast<unsigned>(std::clamp(std::log2(columns) / entropy, 8., 26.));
}

void run_flann_recall(const FlannRecallOptions& options) {
  std::string csv = "index,rows,density,columns,k,recall,us_per_query,build_seconds\n";
  std::printf("%-14s %6s %8s %8s %4s %8s %12s %9s\n", "index", "rows", "density", "columns", "k", "recall",
              "us a query", "build s");
  for (const std::uint32_t rows : options.rows) {
    for (const double density : options.densities) {
      BitRows columns = clustered_columns(rows, density, options);
      const std::uint32_t count = columns.shape().rows, k = std::min(options.k, count - 1);
      const auto report = [&](const char* name, const RecallMeasured& m) {
        std::printf("%-14s %6u %8g %8u %4u %8.4f %12.1f %9.3f\n", name, rows, density, count, k, m.recall,
                    m.us_per_query, m.build_seconds);
        std::fflush(stdout);
        char line[200];
        std::snprintf(line, sizeof line, "%s,%u,%g,%u,%u,%.4f,%.1f,%.4f\n", name, rows, density, count, k,
                      m.recall, m.us_per_query, m.build_seconds);
        csv += line;
      };
      std::vector<Distances> truth;
      const double start = processor_seconds();
      for (std::uint32_t q = 0; q < std::min(options.queries, count); ++q)
        truth.push_back(scan(columns, q, k));
      report("scan", {1, (processor_seconds() - start) * 1e6 / static_cast<double>(truth.size()), 0});
      const FlannOptions chosen;
      report("hierarchical",
             measure(columns, truth,
                     flann::HierarchicalClusteringIndexParams(
                         static_cast<int>(chosen.branching), flann::FLANN_CENTERS_RANDOM,
                         static_cast<int>(chosen.trees), static_cast<int>(chosen.leaf_points)),
                     static_cast<int>(chosen.checks), k));
      report("lsh", measure(columns, truth, flann::LshIndexParams(), 32, k));
      report("lsh-long-keys",
             measure(columns, truth, flann::LshIndexParams(6, sensible_key(density, count), 0), 32, k));
    }
  }
  write_table(options.csv, csv);
}

}  // namespace

void add_flann_recall(const Verb& verb) {
  const auto o = std::make_shared<FlannRecallOptions>();
  verb.option("--rows", o->rows, "Numbers of rows of the matrices");
  verb.option("--density", o->densities, "Shares of ones in each column").between(1e-6, .5);
  verb.option("--columns", o->columns, "Number of columns, before equal ones are collapsed")
      .between(100u, 10'000'000u);
  verb.option("-k,--neighbours", o->k, "Number of neighbours sought for each column").positive();
  verb.option("--queries", o->queries, "Number of columns whose neighbours are sought").positive();
  verb.option("--seed", o->seed, "Seed of the columns; FLANN has seeds of its own");
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.example("bench flann-recall --rows 1024 --density 0.01 0.05 --csv flann.csv");
  verb.runs([o] { run_flann_recall(*o); });
}

}  // namespace vismat::bench
