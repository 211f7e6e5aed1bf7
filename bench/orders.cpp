// Every order of the table on any matrices: runs, what a random order has, a proven bound, seconds, peak
// memory.
//
//   orders --out FOLDER [--side columns|rows] MATRIX.bsp.h5 ...
//
// Writes FOLDER/orders.csv, a line a matrix and method, and FOLDER/orders_bounds.csv, the ascent of each
// matrix's bound. Each order is made in a process of its own, up to five times within two seconds; its peak of
// memory holds the matrix too. `random` is one order; fewer_than_random is against the mean of all orders, which
// is known exactly.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "layout/bounds/bound.h"
#include "layout/cost.h"
#include "layout/orders/greedy_order.h"
#include "layout/reordering.h"
#include "matrix/base/atomic_file.h"
#include "matrix/files/dataset_file.h"
#include "programs/measuring.h"

namespace {

using namespace vismat;
using namespace vismat::bench;

struct Options {
  std::filesystem::path out = "out";
  std::string side = "columns";
  std::vector<std::string> methods, files;
  ReorderingOptions order;
  bool append = false;
};

constexpr const char* header =
    "matrix,side,rows,columns,ones,method,runs,fewer_than_random,bound,gap,seconds_median,seconds_spread,"
    "cpu_seconds,repeats,peak_bytes,seed,threads\n";
constexpr const char* bounds_header = "matrix,side,step,bound,least_runs,seconds,cpu_seconds\n";

// One side of a matrix, seen as columns.
struct Side {
  std::string matrix_name, name;
  Dataset data;
};

Side load(const std::string& file, const std::string& side) {
  Side result{name_of(file), side, read_dataset(file)};
  Dataset& data = result.data;
  if (side == "rows") {
    data.matrix = transpose(data.matrix);
    std::swap(data.row_bounds, data.column_bounds);
  } else {
    data.row_neighbours.reset();
  }
  return result;
}

struct Measured {
  std::string method;
  double runs, seconds, spread, cpu, repeats, peak;
};

// The figures, then the order. Nothing where the method lacks what it needs.
std::vector<double> figures(const Side& side, const std::string& method, const Options& options) {
  const VisibilityMatrix& matrix = side.data.matrix;
  ReorderingOptions order_options = options.order;
  order_options.column_bounds = side.data.column_bounds;
  const auto make_order = [&] {
    if (method == "neighbours") return order_rows_by_neighbours(transpose(matrix), *side.data.row_neighbours);
    return find_reordering(method).order_columns(matrix, order_options);
  };
  try {
    std::vector<double> seconds;
    double spent = 0, cpu = processor_seconds();
    Permutation order;
    do {
      const double start = wall_seconds();
      order = make_order();
      seconds.push_back(wall_seconds() - start);
      spent += seconds.back();
    } while (seconds.size() < 5 && spent < 2);
    cpu = (processor_seconds() - cpu) / static_cast<double>(seconds.size());
    const auto peak = static_cast<double>(peak_bytes());
    std::sort(seconds.begin(), seconds.end());
    const auto runs = count_runs(matrix, order);
    std::vector<double> result = {static_cast<double>(runs),           seconds[seconds.size() / 2],
                                  seconds.back() - seconds.front(),    cpu,
                                  static_cast<double>(seconds.size()), peak};
    const std::vector<std::uint32_t> visits = order.old_of_new();
    result.insert(result.end(), visits.begin(), visits.end());
    return result;
  } catch (const std::invalid_argument& error) {
    std::printf("  %-14s left out: %s\n", method.c_str(), error.what());
    return {};
  }
}

std::vector<std::string> methods_of(const Side& side, const Options& options) {
  std::vector<std::string> methods;
  for (const Reordering& method : reorderings()) methods.emplace_back(method.name);
  if (side.data.row_neighbours) methods.emplace_back("neighbours");
  if (options.methods.empty()) return methods;
  std::erase_if(methods, [&](const std::string& m) {
    return std::count(options.methods.begin(), options.methods.end(), m) == 0;
  });
  return methods;
}

void add_tables(const Side& side, const Options& options, std::string& csv, std::string& bounds_csv) {
  const Shape shape = side.data.matrix.shape();
  std::printf("\n%s, %s: %u rows x %u columns, %ju ones\n", side.matrix_name.c_str(), side.name.c_str(),
              shape.rows, shape.columns, std::uintmax_t{side.data.matrix.ones()});
  std::vector<Measured> results;
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
  for (const Measured& m : results) {
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

// What stands there already, or the header.
std::string begin(const std::filesystem::path& path, const char* first_line, bool append) {
  if (!append || !std::filesystem::exists(path)) return first_line;
  const std::vector<std::byte> bytes = read_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void run(const Options& options) {
  const auto orders = options.out / "orders.csv", bounds = options.out / "orders_bounds.csv";
  std::string csv = begin(orders, header, options.append);
  std::string bounds_csv = begin(bounds, bounds_header, options.append);
  for (const std::string& file : options.files) {
    add_tables(load(file, options.side), options, csv, bounds_csv);
    write_file(orders, std::as_bytes(std::span(csv)));
    write_file(bounds, std::as_bytes(std::span(bounds_csv)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Every order of the table on any matrices, each in a process of its own");
  Options options;
  app.add_option("--out", options.out, "Folder for orders.csv and orders_bounds.csv")->capture_default_str();
  app.add_option("--side", options.side)->check(CLI::IsMember({"columns", "rows"}))->capture_default_str();
  app.add_option("--method", options.methods, "These alone");
  app.add_option("--seed", options.order.seed)->capture_default_str();
  app.add_option("--threads", options.order.threads, "0: one a core")->capture_default_str();
  app.add_flag("--append", options.append, "Add to the files in the folder");
  app.add_option("matrices", options.files, "Matrix files")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "orders: %s\n", error.what());
    return 1;
  }
}
