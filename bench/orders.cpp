// Measures every order of the table on any matrices: runs, what a random order has, a proven bound, seconds, peak memory.
//
// Writes FOLDER/orders.csv, a line a matrix and method, and FOLDER/orders_bounds.csv, the ascent of each
// matrix's bound. Each order is made in a process of its own, up to five times within two seconds; its peak of
// memory holds the matrix too. `random` is one order; fewer_than_random is against the mean of all orders, which
// is known exactly.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "layout/bounds/bound.h"
#include "layout/cost.h"
#include "layout/orders/greedy_order.h"
#include "layout/reordering.h"
#include "matrix/files/dataset_file.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"

namespace vismat::bench {
namespace {

struct OrdersOptions {
  std::filesystem::path out = "out";
  std::string side = "columns";
  std::vector<std::string> methods, files;
  ReorderingOptions order;
  bool append = false;
};

constexpr const char* orders_header =
    "matrix,side,rows,columns,ones,method,runs,fewer_than_random,bound,gap,seconds_median,seconds_spread,"
    "cpu_seconds,repeats,peak_bytes,seed,threads\n";
constexpr const char* orders_bounds_header = "matrix,side,step,bound,least_runs,seconds,cpu_seconds\n";

// One side of a matrix, seen as columns.
struct SideToOrder {
  std::string matrix_name, name;
  Dataset data;
};

SideToOrder load(const std::string& file, const std::string& side) {
  SideToOrder result{matrix_name(file), side, read_dataset(file)};
  Dataset& data = result.data;
  if (side == "rows") {
    data.matrix = transpose(data.matrix);
    std::swap(data.row_bounds, data.column_bounds);
  } else {
    data.row_neighbours.reset();
  }
  return result;
}

struct OrderMeasured {
  std::string method;
  double runs, seconds, spread, cpu, repeats, peak;
};

// The figures, then the order. Nothing where the method lacks what it needs.
std::vector<double> figures(const SideToOrder& side, const std::string& method,
                            const OrdersOptions& options) {
  const VisibilityMatrix& matrix = side.data.matrix;
  ReorderingOptions order_options = options.order;
  order_options.column_bounds = side.data.column_bounds;
  const auto make_order = [&] {
    if (method == "neighbours") return order_rows_by_neighbours(transpose(matrix), *side.data.row_neighbours);
    return find_reordering(method).order_columns(matrix, order_options);
  };
  try {
    Permutation order;
    const double cpu = processor_seconds();
    const Times times = time_passes({.seconds = 2, .least = 1, .most = 5}, [&] { order = make_order(); });
    const auto passes = static_cast<double>(times.passes);
    const double cpu_of_pass = (processor_seconds() - cpu) / passes;
    const auto peak = static_cast<double>(peak_bytes());
    std::vector<double> result = {static_cast<double>(count_runs(matrix, order)),
                                  times.median,
                                  times.most - times.least,
                                  cpu_of_pass,
                                  passes,
                                  peak};
    const std::vector<std::uint32_t> visits = order.old_of_new();
    result.insert(result.end(), visits.begin(), visits.end());
    return result;
  } catch (const std::invalid_argument& error) {
    std::printf("  %-14s left out: %s\n", method.c_str(), error.what());
    return {};
  }
}

std::vector<std::string> methods_of(const SideToOrder& side, const OrdersOptions& options) {
  std::vector<std::string> methods;
  for (const Reordering& method : reorderings()) methods.emplace_back(method.name);
  if (side.data.row_neighbours) methods.emplace_back("neighbours");
  if (options.methods.empty()) return methods;
  std::erase_if(methods, [&](const std::string& m) {
    return std::count(options.methods.begin(), options.methods.end(), m) == 0;
  });
  return methods;
}

void add_tables(const SideToOrder& side, const OrdersOptions& options, std::string& csv,
                std::string& bounds_csv) {
  const Shape shape = side.data.matrix.shape();
  std::printf("\n%s, %s: %u rows x %u columns, %ju ones\n", side.matrix_name.c_str(), side.name.c_str(),
              shape.rows, shape.columns, std::uintmax_t{side.data.matrix.ones()});
  std::vector<OrderMeasured> results;
  Permutation best = Permutation::identity(shape.columns);
  double least = static_cast<double>(count_runs(side.data.matrix));
  for (const std::string& method : methods_of(side, options)) {
    const auto n = apart<double>([&] { return figures(side, method, options); });
    if (n.empty()) continue;
    results.push_back({method, n[0], n[1], n[2], n[3], n[4], n[5]});
    if (n[0] < least && method != "flann-tour") {  // the bound is to be the same each time
      least = n[0];
      best = Permutation::from_old_of_new({n.begin() + 6, n.end()});
    }
  }
  // The bound, its seconds of both kinds, its ascent.
  const auto ascent = apart<double>([&] {
    const double start = wall_seconds(), cpu = processor_seconds();
    const LowerBound bound = lower_bound(side.data.matrix, best, {.threads = options.order.threads});
    std::vector<double> result = {static_cast<double>(bound.runs), wall_seconds() - start,
                                  processor_seconds() - cpu};
    result.insert(result.end(), bound.history.begin(), bound.history.end());
    return result;
  });
  const double bound = ascent[0];
  for (std::size_t step = 3; step < ascent.size(); ++step) {
    bounds_csv += csv_line(side.matrix_name, side.name, step - 2, ascent[step], least, ascent[1], ascent[2]);
  }

  const double random = mean_runs_of_random(side.data.matrix);
  std::printf("  %-14s %12s %9s %9s %9s %8s %8s %8s\n", "method", "runs", "fewer", "to bound", "seconds",
              "spread", "cpu s", "peak MB");
  for (const OrderMeasured& m : results) {
    const double fewer = random == 0 ? 0 : 1 - m.runs / random, gap = bound == 0 ? 0 : m.runs / bound - 1;
    std::printf("  %-14s %12.0f %7.1f %% %7.2f %% %9.3f %8.3f %8.3f %8.0f\n", m.method.c_str(), m.runs,
                100 * fewer, 100 * gap, m.seconds, m.spread, m.cpu, m.peak / 1e6);
    csv += csv_line(side.matrix_name, side.name, shape.rows, shape.columns, side.data.matrix.ones(), m.method,
                    m.runs, fewer, bound, gap, m.seconds, m.spread, m.cpu, m.repeats, m.peak,
                    options.order.seed, options.order.threads);
  }
  std::printf("  no order has fewer than %.0f runs (%.1f s); a random one has %.0f on average\n", bound,
              ascent[1], random);
  std::fflush(stdout);
}

void run_orders(const OrdersOptions& options) {
  const auto orders = options.out / "orders.csv", bounds = options.out / "orders_bounds.csv";
  std::string csv = table_begin(orders, orders_header, options.append);
  std::string bounds_csv = table_begin(bounds, orders_bounds_header, options.append);
  for (const std::string& file : options.files) {
    add_tables(load(file, options.side), options, csv, bounds_csv);
    write_table(orders, csv);
    write_table(bounds, bounds_csv);
  }
}

}  // namespace

void add_orders(const Verb& verb) {
  const auto o = std::make_shared<OrdersOptions>();
  verb.output("--out", o->out, Written::folder, "Folder for orders.csv and orders_bounds.csv");
  verb.option("--side", o->side, "Whether columns or rows are ordered").one_of({"columns", "rows"});
  verb.option("--orders", o->methods, "Orders, named as in 'vismat order'; every one if none is named")
      .comma_separated();
  verb.option("--seed", o->order.seed, "Seed of the orders that draw random numbers");
  verb.threads(o->order.threads);
  verb.flag("--append", o->append, "Add to the files in the folder");
  verb.input("MATRIX", o->files, "Matrix files").required();
  verb.example("bench orders koth1.bsp.h5 --out out --orders exact-tour,best");
  verb.runs([o] { run_orders(*o); });
}

}  // namespace vismat::bench
