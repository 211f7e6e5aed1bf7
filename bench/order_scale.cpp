// Measures what orders at the papers' scale cost: runs, bounds, seconds and peak memory of synthetic scenes of growing size, each
// method in a process of its own.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "layout/bounds/held_karp.h"
#include "layout/bounds/nearest_bound.h"
#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "layout/tours/sampled_tour.h"
#include "layout/tours/scale_tour.h"
#include "matrix/generate.h"
#include "programs/csv.h"
#include "programs/measuring.h"

namespace vismat::bench {
namespace {

struct OrderScaleOptions {
  std::string scene = "power-plant";
  bool harder = false;
  std::vector<double> scales = {1. / 64, 1. / 16};
  std::vector<std::string> methods = {"sampled-tour", "scale-tour"};
  std::uint32_t most_held_karp = 30000;
  unsigned threads = 0;
  std::uint64_t seed = 1;
  std::filesystem::path csv;
};

// What a child reports; all plain numbers, as it comes through a pipe.
struct ScaleMeasured {
  std::uint32_t rows, columns;
  std::uint64_t ones, runs, two_nearest, held_karp, peak_bytes;
  double order_seconds, order_cpu_seconds, two_nearest_seconds, held_karp_seconds;
};

DeltaSceneOptions scene_of(const OrderScaleOptions& options, double scale) {
  DeltaSceneOptions scene =
      options.scene == "city" ? city_scene(scale, options.harder) : power_plant_scene(scale, options.harder);
  scene.seed = options.seed;
  return scene;
}

ScaleMeasured measure(const OrderScaleOptions& options, double scale, const std::string& method) {
  const VisibilityMatrix matrix = generate_delta_scene(scene_of(options, scale), options.threads);
  ScaleMeasured m{matrix.shape().rows, matrix.shape().columns, matrix.ones(), 0, 0, 0, 0, 0, 0, 0, 0};
  const double start = wall_seconds(), cpu_start = processor_seconds();
  if (method == "scale-tour") {
    const SparsePoints points(matrix);
    const auto visits = visits_at_scale(points, {.nearby = {.seed = options.seed}}, options.threads);
    m.order_seconds = wall_seconds() - start;
    m.order_cpu_seconds = processor_seconds() - cpu_start;
    m.peak_bytes = peak_bytes();
    m.runs = runs_of_visits(points, visits, options.threads);
    const double certifying = wall_seconds();
    m.two_nearest = two_nearest_bound(points, visits, {}, options.threads);
    m.two_nearest_seconds = wall_seconds() - certifying;
    if (points.size() <= options.most_held_karp) {
      const double ascending = wall_seconds();
      m.held_karp = held_karp_bound(points, visits, {.threads = options.threads}).runs;
      m.held_karp_seconds = wall_seconds() - ascending;
    }
    return m;
  }
  Permutation order;
  if (method == "sampled-tour") {
    const auto neighbours = static_cast<std::uint32_t>(std::max(8., std::round(700 * scale)));
    const std::uint32_t samples = neighbours * (options.scene == "city" ? 32 : 16);  // as the paper reports
    const SampledTourOptions sampling{.neighbours = neighbours, .samples = samples, .seed = options.seed};
    order = order_by_sampled_tour(matrix, sampling, options.threads);
  } else {
    order = random_order(m.columns, options.seed);
  }
  m.order_seconds = wall_seconds() - start;
  m.order_cpu_seconds = processor_seconds() - cpu_start;
  m.peak_bytes = peak_bytes();
  m.runs = count_runs(matrix, order);
  return m;
}

// Growth of a cost from one size to the next, as an exponent of the ones.
double exponent(double cost, double cost_before, double ones, double ones_before) {
  return std::log(cost / cost_before) / std::log(ones / ones_before);
}

void run_order_scale(const OrderScaleOptions& options) {
  std::string csv =
      "scene,harder,scale,rows,columns,ones,method,runs,runs_per_random,two_nearest,held_karp,order_seconds,"
      "order_cpu_seconds,two_nearest_seconds,held_karp_seconds,peak_bytes,threads,seed\n";
  std::printf("%-12s %8s %8s %10s %11s %8s %8s %8s %8s %8s %8s %8s %8s %7s %7s\n", "method", "scale",
              "columns", "ones", "runs", "/random", "/2-near", "/HK", "order s", "cpu s", "2-near s", "HK s",
              "peak GB", "cpu ~", "GB ~");
  struct Before {
    double ones = 0, seconds = 0, peak = 0;
  };
  std::map<std::string, Before> before;
  for (const double scale : options.scales) {
    double random_runs = 0;
    for (const std::string method : {"random", "sampled-tour", "scale-tour"}) {
      if (method != "random" && std::count(options.methods.begin(), options.methods.end(), method) == 0)
        continue;
      const ScaleMeasured m =
          apart<ScaleMeasured>([&] { return std::vector{measure(options, scale, method)}; }).front();
      const auto peak = static_cast<double>(m.peak_bytes);
      const auto runs = static_cast<double>(m.runs), ones = static_cast<double>(m.ones);
      if (method == "random") random_runs = runs;
      const auto per = [&](std::uint64_t bound) {
        return bound == 0 ? 0 : runs / static_cast<double>(bound);
      };
      std::printf("%-12s %8.5f %8u %10.0f %11.0f %8.4f %8.4f %8.4f %8.2f %8.2f %8.2f %8.2f %8.2f",
                  method.c_str(), scale, m.columns, ones, runs, runs / random_runs, per(m.two_nearest),
                  per(m.held_karp), m.order_seconds, m.order_cpu_seconds, m.two_nearest_seconds,
                  m.held_karp_seconds, peak / 1e9);
      Before& last = before[method];
      if (last.ones > 0) {
        std::printf(" %7.2f %7.2f", exponent(m.order_cpu_seconds, last.seconds, ones, last.ones),
                    exponent(peak, last.peak, ones, last.ones));
      }
      std::printf("\n");
      std::fflush(stdout);
      last = {ones, m.order_cpu_seconds, peak};
      csv +=
          csv_line(options.scene, options.harder, scale, m.rows, m.columns, m.ones, method, m.runs,
                   runs / random_runs, m.two_nearest, m.held_karp, m.order_seconds, m.order_cpu_seconds,
                   m.two_nearest_seconds, m.held_karp_seconds, m.peak_bytes, options.threads, options.seed);
    }
  }
  write_table(options.csv, csv);
}

}  // namespace

void add_order_scale(const Verb& verb) {
  const auto o = std::make_shared<OrderScaleOptions>();
  verb.option("--scene", o->scene, "Which scene of Chhugani et al. 2005 the synthetic matrix imitates")
      .one_of({"power-plant", "city"});
  verb.flag("--harder", o->harder, "A variant of it that is less redundant and so harder to order");
  verb.option("--scale", o->scales, "Sizes of the matrix as shares of the paper's, from small to large")
      .between(1e-4, 1.);
  verb.option("--orders", o->methods, "Orders that are measured beside the random order")
      .comma_separated()
      .one_of({"sampled-tour", "scale-tour"});
  verb.option("--held-karp", o->most_held_karp,
              "Largest number of distinct columns for which the bound of Held and Karp is computed too");
  verb.threads(o->threads);
  verb.option("--seed", o->seed, "Seed of the matrix and of the orders");
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.example("bench order-scale --scene city --scale 0.015625 0.0625 --csv scale.csv");
  verb.runs([o] { run_order_scale(*o); });
}

}  // namespace vismat::bench
