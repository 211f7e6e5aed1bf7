// Measures where orders fail: studies on adversarial matrices and on given ones.
//
// Writes to FOLDER:
//   failures_shapes.csv   every order on small synthetic matrices, by study and its parameter: structureless
//                         random matrices by density; near-duplicates by bits flipped in each copy; random rows
//                         before the others; planted block orders by noise; zero and full columns; one row, one
//                         column. `planted` is the number of runs in the order in which the matrix was made, before its
//                         columns were shuffled, `random` the mean of all orders.
//   failures_samples.csv  sampled-tour by sample size and k, beside exact-tour and the bound
//   failures_seeds.csv    the spread of seeded orders over their seeds
//   failures_recall.csv   nearby_points against brute force: share of the k nearest found
// The last three are made from the given matrices and the synthetic power plant at --scale; the seeds' from a quarter of it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "layout/bounds/bound.h"
#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "layout/reordering.h"
#include "layout/tours/sampled_tour.h"
#include "matrix/base/parallel.h"
#include "matrix/base/random.h"
#include "matrix/files/dataset_file.h"
#include "matrix/generate.h"
#include "matrix/points/sketch.h"
#include "matrix/points/sparse_points.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"

namespace vismat::bench {
namespace {

struct OrderFailuresOptions {
  std::filesystem::path out = "out";
  std::vector<std::string> files;
  double scale = 1. / 64;
  std::uint32_t seeds = 20;
  std::uint32_t columns = 400;  // of the synthetic matrices; as many rows
  std::uint32_t queries = 500;
};

struct Named {
  std::string name;
  VisibilityMatrix matrix;
};

// ---- synthetic matrices, columns in their planted order ---------------------------------------------------

using Rows = std::vector<std::vector<bool>>;

VisibilityMatrix matrix_of(const Rows& rows, std::uint32_t columns) {
  std::vector<std::vector<std::uint32_t>> ids(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      if (rows[r][c]) ids[r].push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(ids, columns);
}

Rows random_rows(std::uint32_t rows, std::uint32_t columns, double density, Random& random) {
  Rows result(rows, std::vector<bool>(columns));
  for (auto& row : result) {
    for (std::uint32_t c = 0; c < columns; ++c) row[c] = random.fraction() < density;
  }
  return result;
}

// Each row sees two intervals of a twentieth to a fifth of the columns.
Rows blocks(std::uint32_t rows, std::uint32_t columns, Random& random) {
  Rows result(rows, std::vector<bool>(columns));
  for (auto& row : result) {
    for (int interval = 0; interval < 2; ++interval) {
      const std::uint32_t length = columns / 20 + random.below(columns * 3 / 20 + 1);
      const std::uint32_t first = random.below(columns);
      for (std::uint32_t c = first; c < std::min(columns, first + length); ++c) row[c] = true;
    }
  }
  return result;
}

void flip(Rows& rows, double share, Random& random) {
  for (auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = row[c] != (random.fraction() < share);
  }
}

// ---- every order on one matrix ---------------------------------------------------------------------------

void add_shape(const char* study, double parameter, const VisibilityMatrix& planted, std::string& csv) {
  const Permutation shuffle = random_order(planted.shape().columns, 99);
  const VisibilityMatrix matrix = permute(planted, Permutation::identity(planted.shape().rows), shuffle);
  struct Result {
    std::string_view method;
    std::uint64_t runs;
  };
  std::vector<Result> results;
  Permutation best = Permutation::identity(matrix.shape().columns);
  std::uint64_t least = count_runs(matrix);
  for (const Reordering& method : reorderings()) {
    if (method.name == "morton") continue;  // knows no matrix, only boxes
    const Permutation order = method.order_columns(matrix, {});
    results.push_back({method.name, count_runs(matrix, order)});
    if (results.back().runs < least &&
        method.name != "flann-tour") {  // the bound is to be the same each time
      least = results.back().runs;
      best = order;
    }
  }
  const std::uint64_t bound = lower_bound(matrix, best).runs;
  for (const Result& result : results)
    csv += csv_line(study, parameter, planted.shape().rows, planted.shape().columns, matrix.ones(),
                    result.method, result.runs, mean_runs_of_random(matrix), count_runs(planted), bound);
}

std::string shapes(const OrderFailuresOptions& options) {
  std::string csv = "study,parameter,rows,columns,ones,method,runs,random,planted,bound\n";
  const std::uint32_t n = options.columns;
  for (const double density : {.005, .02, .1, .3, .5, .9}) {
    Random random(1);
    add_shape("random", density, matrix_of(random_rows(n, n, density, random), n), csv);
  }
  for (const std::uint32_t flips : {0u, 1u, 4u, 16u, 64u}) {
    Random random(2);
    constexpr std::uint32_t copies = 10;
    Rows rows = random_rows(n, n / copies, .2, random);
    for (auto& row : rows) {
      std::vector<bool> wide(n);
      for (std::uint32_t c = 0; c < n; ++c) wide[c] = row[std::min<std::size_t>(c / copies, row.size() - 1)];
      row = wide;
    }
    for (std::uint32_t c = 0; c < n; ++c) {
      for (std::uint32_t f = 0; f < flips; ++f) rows[random.below(n)][c].flip();
    }
    add_shape("near-duplicates", flips, matrix_of(rows, n), csv);
  }
  for (const std::uint32_t noisy : {0u, 1u, 2u, 4u, 8u, 16u}) {
    Random random(3);
    Rows rows = random_rows(noisy, n, .5, random);
    const Rows others = blocks(n, n, random);
    rows.insert(rows.end(), others.begin(), others.end());
    add_shape("random rows first", noisy, matrix_of(rows, n), csv);
  }
  for (const std::uint32_t copies : {0u, 1u, 10u, 100u, 1000u}) {
    Random random(4);
    Rows rows = blocks(n, n, random);
    const auto dominant = random_rows(1, n, .5, random).front();
    rows.insert(rows.end(), copies, dominant);
    add_shape("dominant row", copies, matrix_of(rows, n), csv);
  }
  for (const double noise : {0., .002, .01, .03, .1, .3}) {
    Random random(5);
    Rows rows = blocks(n, n, random);
    flip(rows, noise, random);
    add_shape("planted blocks", noise, matrix_of(rows, n), csv);
  }
  for (const double share : {0., .25, .5, .9}) {
    Random random(6);
    Rows rows = blocks(n, n, random);
    const auto each = static_cast<std::uint32_t>(share * n / 2);
    for (auto& row : rows) {
      std::fill(row.begin(), row.begin() + each, false);
      std::fill(row.end() - each, row.end(), true);
    }
    add_shape("zero and full columns", share, matrix_of(rows, n), csv);
  }
  Random random(7);
  add_shape("one row", 1, matrix_of(random_rows(1, n, .5, random), n), csv);
  add_shape("one column", 1, matrix_of(random_rows(n, 1, .5, random), 1), csv);
  return csv;
}

// ---- studies on given matrices ----------------------------------------------------------------------------

std::string samples(const std::vector<Named>& matrices) {
  std::string csv =
      "matrix,columns,one_in,samples,k_one_in,neighbours,flips,runs,exact_tour,random,bound,seconds,"
      "cpu_seconds\n";
  for (const Named& m : matrices) {
    const std::uint32_t columns = m.matrix.shape().columns;
    const auto exact = count_runs(m.matrix, find_reordering("exact-tour").order_columns(m.matrix, {}));
    const std::uint64_t bound =
        lower_bound(m.matrix, find_reordering("best").order_columns(m.matrix, {})).runs;
    for (const std::uint32_t share : {64u, 16u, 4u, 1u}) {
      const std::uint32_t sampled = std::max(2u, columns / share);
      for (const std::uint32_t part : {16u, 4u, 1u}) {
        for (const bool flips : {false, true}) {
          const std::uint32_t k = std::max(1u, sampled / part);
          const double start = wall_seconds(), cpu = processor_seconds();
          const Permutation order =
              order_by_sampled_tour(m.matrix, {.neighbours = k, .samples = sampled, .flip_edges = flips});
          csv += csv_line(m.name, columns, share, sampled, part, k, flips, count_runs(m.matrix, order), exact,
                          mean_runs_of_random(m.matrix), bound, wall_seconds() - start,
                          processor_seconds() - cpu);
        }
      }
    }
  }
  return csv;
}

// Not of orders that take no seed (their first two give the same runs) or are another one here under a second name.
std::string seeds(const std::vector<Named>& matrices, const OrderFailuresOptions& options) {
  std::string csv = "matrix,columns,method,seeds,mean,deviation,least,most\n";
  for (const Named& m : matrices) {
    const std::uint32_t columns = m.matrix.shape().columns;
    std::set<std::pair<double, double>> first_two;
    const auto add = [&](std::string_view name, const std::function<Permutation(std::uint64_t)>& order) {
      const auto runs_of = [&](std::uint64_t seed) {
        return static_cast<double>(count_runs(m.matrix, order(seed)));
      };
      std::vector<double> runs(options.seeds);
      runs[0] = runs_of(1);
      runs[1] = runs_of(2);
      if (runs[0] == runs[1] || !first_two.emplace(runs[0], runs[1]).second) return;
      parallel_for(options.seeds - 2, 0, [&](std::uint64_t i) { runs[i + 2] = runs_of(i + 3); });
      const double mean = std::accumulate(runs.begin(), runs.end(), 0.) / options.seeds;
      double squares = 0;
      for (const double r : runs) squares += (r - mean) * (r - mean);
      const auto [least, most] = std::minmax_element(runs.begin(), runs.end());
      csv += csv_line(m.name, columns, name, options.seeds, mean, std::sqrt(squares / (options.seeds - 1)),
                      *least, *most);
    };
    for (const Reordering& method : reorderings()) {
      if (method.name == "morton") continue;
      add(method.name, [&](std::uint64_t seed) {
        ReorderingOptions one;
        one.seed = seed;
        one.threads = 1;
        return method.order_columns(m.matrix, one);
      });
    }
    const std::uint32_t sampled = std::max(2u, columns / 8);
    add("sampled-tour of 1/8", [&](std::uint64_t seed) {
      return order_by_sampled_tour(
          m.matrix, {.neighbours = std::max(1u, sampled / 16), .samples = sampled, .seed = seed}, 1);
    });
  }
  return csv;
}

// Ties are no misses: found is what is as near as the k-th nearest.
std::string recall(const std::vector<Named>& matrices, const OrderFailuresOptions& options) {
  std::string csv =
      "matrix,points,rows,mean_weight,sketch_bits,k,recall,nearest_found,seconds,cpu_seconds,"
      "brute_cpu_seconds\n";
  constexpr std::uint32_t k = 10;
  for (const Named& m : matrices) {
    const SparsePoints points(m.matrix);
    if (points.size() <= k) continue;
    const double start = wall_seconds(), cpu = processor_seconds();
    const ColumnSketches sketches(points);
    const NeighbourLists lists = nearby_points(points, sketches, {.neighbours = k});
    const double wall = wall_seconds() - start, used = processor_seconds() - cpu;
    std::uint64_t ones = 0;
    for (std::uint32_t p = 0; p < points.size(); ++p) ones += points.weight(p);
    Random random(8);
    std::uint64_t found = 0, first = 0;
    const double brute = processor_seconds();
    for (std::uint32_t q = 0; q < options.queries; ++q) {
      const std::uint32_t p = random.below(points.size());
      std::vector<std::uint32_t> distances;
      for (std::uint32_t other = 0; other < points.size(); ++other) {
        if (other != p) distances.push_back(points.distance(p, other));
      }
      std::nth_element(distances.begin(), distances.begin() + k - 1, distances.end());
      const std::uint32_t kth = distances[k - 1];
      const std::uint32_t nearest = *std::min_element(distances.begin(), distances.begin() + k);
      std::uint32_t here = 0, least = 0xffffffff;
      for (std::uint32_t i = 0; i < lists.per_point; ++i) {
        const std::size_t at = std::size_t{p} * lists.per_point + i;
        if (lists.distances[at] == 0xffffffff || lists.ids[at] == points.zero()) continue;
        here += lists.distances[at] <= kth;
        least = std::min(least, lists.distances[at]);
      }
      found += std::min(here, k);
      first += least <= nearest;
    }
    const double brute_seconds = (processor_seconds() - brute) / options.queries * points.size();
    csv += csv_line(m.name, points.size(), points.rows(), ones / points.size(), sketches.bits(), k,
                    static_cast<double>(found) / (options.queries * k),
                    static_cast<double>(first) / options.queries, wall, used, brute_seconds);
  }
  return csv;
}

void run_order_failures(const OrderFailuresOptions& options) {
  std::vector<Named> matrices;
  for (const std::string& file : options.files)
    matrices.push_back({matrix_name(file), read_dataset(file).matrix});
  matrices.push_back({"power plant", generate_delta_scene(power_plant_scene(options.scale))});
  const auto tell = [&](const char* name, const std::string& csv, double since) {
    write_table(options.out / name, csv);
    std::printf("%-22s %4ju lines, %.1f s\n", name,
                std::uintmax_t(std::count(csv.begin(), csv.end(), '\n') - 1), wall_seconds() - since);
    std::fflush(stdout);
  };
  double start = wall_seconds();
  tell("failures_shapes.csv", shapes(options), start);
  start = wall_seconds();
  tell("failures_samples.csv", samples(matrices), start);
  start = wall_seconds();
  tell("failures_recall.csv", recall(matrices, options), start);
  start = wall_seconds();
  matrices.back().matrix = generate_delta_scene(power_plant_scene(options.scale / 4));  // forty orders each
  tell("failures_seeds.csv", seeds(matrices, options), start);
}

}  // namespace

void add_order_failures(const Verb& verb) {
  const auto o = std::make_shared<OrderFailuresOptions>();
  verb.output("--out", o->out, Written::folder, "Folder for the tables");
  verb.option("--scale", o->scale, "Size of the synthetic power plant, as a share of the paper's")
      .between(1e-4, 1.);
  verb.option("--seeds", o->seeds, "Number of seeds that each order is run with").between(3u, 1000u);
  verb.option("--columns", o->columns, "Number of columns of the adversarial matrices").between(40u, 10'000u);
  verb.option("--queries", o->queries,
              "Number of columns whose nearest columns are also sought by brute force")
      .between(1u, 1'000'000u);
  verb.input("MATRIX", o->files, "Matrix files");
  verb.example("bench order-failures --out out city32.bsp.h5");
  verb.runs([o] { run_order_failures(*o); });
}

}  // namespace vismat::bench
