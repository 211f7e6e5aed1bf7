// Measures how many points lie near a random point, by the number of points and by the distance: Fig. 6 of Chhugani et al. 2005.
//
// Points are distinct columns: a column that has an equal one would have its nearest neighbour at distance 0,
// and only its equals would lie within twice that distance. Prints the share of columns that have an equal one too. Writes
// FOLDER/distance_density.csv (a: the share of other points within twice the nearest one's distance, in random
// subsets of growing size; in the whole set it is the paper's alpha) and FOLDER/distance_radius.csv (b: the
// share within multiples of the nearest one's distance, in the whole set). Both are means over random points.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "layout/orders/random_order.h"
#include "matrix/base/parallel.h"
#include "matrix/base/random.h"
#include "matrix/files/dataset_file.h"
#include "matrix/generate.h"
#include "matrix/points/column_points.h"
#include "matrix/points/distinct_columns.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"

namespace vismat::bench {
namespace {

struct DistanceStatisticsOptions {
  std::filesystem::path out = "out";
  std::vector<std::string> files;
  double scale = 0;
  std::uint32_t trials = 200;
  std::uint64_t seed = 1;
};

struct Tables {
  std::string density =
      "matrix,columns,distinct,with_an_equal,points,within_twice,within_twice_median,trials\n";
  std::string radius = "matrix,multiple,within,trials\n";
};

// Ascending distances of a subset's first point to its others.
std::vector<std::uint32_t> distances_of_first(const ColumnPoints& points,
                                              std::span<const std::uint32_t> subset) {
  std::vector<std::uint32_t> distances(subset.size() - 1);
  for (std::size_t i = 1; i < subset.size(); ++i) distances[i - 1] = points.distance(subset[0], subset[i]);
  std::sort(distances.begin(), distances.end());
  return distances;
}

double share_within(const std::vector<std::uint32_t>& ascending, double radius) {
  const auto end = std::upper_bound(ascending.begin(), ascending.end(), radius);
  return static_cast<double>(end - ascending.begin()) / static_cast<double>(ascending.size());
}

double share_with_an_equal(const DistinctColumns& distinct) {
  std::vector<std::uint32_t> of_kind(distinct.matrix.shape().columns, 0);
  for (const std::uint32_t kind : distinct.distinct_of_column) ++of_kind[kind];
  const auto columns = static_cast<double>(distinct.distinct_of_column.size());
  return 1 - static_cast<double>(std::count(of_kind.begin(), of_kind.end(), 1u)) / columns;
}

// Shares within twice and within multiples of the nearest one's distance, means over random points of random
// subsets; of twice the median too. Trials are independent, so their number of threads changes nothing.
struct Shares {
  double twice = 0, median_twice = 0;
  std::vector<double> within = std::vector<double>(25, 0.);
};

double multiple(std::size_t i) {
  return std::exp2(static_cast<double>(i) / 4);  // up to 64
}

Shares mean_shares(const ColumnPoints& points, std::uint32_t size, const DistanceStatisticsOptions& options) {
  std::vector<Shares> trials(options.trials);
  parallel_for(options.trials, 0, [&](std::uint64_t trial) {
    Random random(options.seed, trial);
    const auto distances = distances_of_first(points, random_sample(points.size(), size, random));
    Shares& shares = trials[trial];
    shares.twice = share_within(distances, 2. * distances.front());
    for (std::size_t i = 0; i < shares.within.size(); ++i)
      shares.within[i] = share_within(distances, distances.front() * multiple(i));
  });
  Shares mean;
  for (const Shares& shares : trials) {
    mean.twice += shares.twice / options.trials;
    for (std::size_t i = 0; i < mean.within.size(); ++i) mean.within[i] += shares.within[i] / options.trials;
  }
  std::vector<double> twice;
  for (const Shares& shares : trials) twice.push_back(shares.twice);
  mean.median_twice = median(std::move(twice));
  return mean;
}

void add_matrix(const std::string& name, const VisibilityMatrix& matrix,
                const DistanceStatisticsOptions& options, Tables& tables) {
  const DistinctColumns distinct = distinct_columns(matrix);
  const ColumnPoints points(distinct.matrix);
  if (points.size() < 2) return;
  Shares shares;
  for (std::uint32_t size = std::min(64u, points.size());; size = std::min(2 * size, points.size())) {
    shares = mean_shares(points, size, options);
    tables.density += csv_line(name, matrix.shape().columns, points.size(), share_with_an_equal(distinct),
                               size, shares.twice, shares.median_twice, options.trials);
    if (size == points.size()) break;
  }
  for (std::size_t i = 0; i < shares.within.size(); ++i)
    tables.radius += csv_line(name, multiple(i), shares.within[i], options.trials);
  std::printf("%-24s %8u columns, %8u distinct: %6.2f %% of them within twice the nearest one's distance\n",
              name.c_str(), matrix.shape().columns, points.size(), 100 * shares.twice);
  std::fflush(stdout);
}

void run_distance_statistics(const DistanceStatisticsOptions& options) {
  Tables tables;
  for (const std::string& file : options.files)
    add_matrix(matrix_name(file), read_dataset(file).matrix, options, tables);
  if (options.scale > 0) {
    for (const bool harder : {false, true}) {
      const std::string suffix = harder ? " harder" : "";
      add_matrix("power plant" + suffix, generate_delta_scene(power_plant_scene(options.scale, harder)),
                 options, tables);
      add_matrix("city" + suffix, generate_delta_scene(city_scene(options.scale, harder)), options, tables);
    }
  }
  write_table(options.out / "distance_density.csv", tables.density);
  write_table(options.out / "distance_radius.csv", tables.radius);
}

}  // namespace

void add_distance_statistics(const Verb& verb) {
  const auto o = std::make_shared<DistanceStatisticsOptions>();
  verb.output("--out", o->out, Written::folder, "Folder for the two tables");
  verb.option("--scale", o->scale, "Also the synthetic matrices, at this share of the paper's size; 0: none")
      .between(1e-4, 1.);
  verb.option("--trials", o->trials, "Number of random points over which each mean is taken")
      .between(1u, 1'000'000u);
  verb.option("--seed", o->seed, "Seed of the random points");
  verb.input("MATRIX", o->files, "Matrix files");
  verb.note("A point is a column; equal columns count once.");
  verb.example("bench distance-statistics koth1.bsp.h5 --out out");
  verb.runs([o] { run_distance_statistics(*o); });
}

}  // namespace vismat::bench
