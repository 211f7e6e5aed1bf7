// vismat order: reorders a matrix's rows, columns or both, and tells how far the order may be from the best.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "layout/best_order.h"
#include "layout/bounds/bound.h"
#include "layout/cost.h"
#include "layout/orders/greedy_order.h"
#include "layout/reordering.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/checksum.h"
#include "matrix/files/dataset_file.h"
#include "programs/measuring.h"
#include "programs/options.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

struct OrderOptions {
  std::filesystem::path in, out, json;
  std::string columns = "identity", rows = "identity";
  std::string bound = "quick";
  double bound_seconds = 60;
  bool symmetric = false;
  std::uint64_t memory = 0;  // bytes; 0: no limit
  ReorderingOptions order;
  BoundOptions bound_options() const {
    return {.seconds = bound == "tight" ? bound_seconds : 0, .stages = show_progress};
  }
};

// One side of the matrix, seen as columns.
struct Result {
  Permutation order;
  std::uint64_t runs_before = 0, runs_after = 0;
  std::optional<std::uint64_t> bound;
  double seconds = 0;
};

Result order_side(const VisibilityMatrix& matrix, const std::string& method, const Dataset& data, bool rows,
                  const OrderOptions& options) {
  const double start = wall_seconds();
  Result result;
  if (method == "neighbours") {
    if (!rows || !data.row_neighbours) {
      throw std::invalid_argument(
          "neighbours orders the rows of a matrix that says which of them are neighbours; use --rows greedy");
    }
    result.order = order_rows_by_neighbours(data.matrix, *data.row_neighbours);
  } else {
    ReorderingOptions side = options.order;
    side.column_bounds = rows ? data.row_bounds : data.column_bounds;
    result.order = find_reordering(method).order_columns(matrix, side);
  }
  result.seconds = wall_seconds() - start;
  result.runs_before = count_runs(matrix);
  result.runs_after = count_runs(matrix, result.order);
  if (options.bound != "none") {
    result.bound = lower_bound(matrix, result.order, options.bound_options()).runs;
  }
  return result;
}

bool goes_out_of_core(const std::string& method) {
  return method == "best" || method == "scale-tour";
}

// The memory in bytes that ordering the columns takes at most: the matrix, its transpose, and what a method stores for each column.
struct Need {
  std::uint64_t in_core, out_of_core;
};
Need memory_needed(const VisibilityMatrix& m, const std::string& method) {
  const Shape shape = m.shape();
  const std::uint64_t matrix = 4 * m.ones() + 8 * std::uint64_t{shape.rows};
  const std::uint64_t transpose = 4 * m.ones() + 8 * std::uint64_t{shape.columns};
  const std::uint64_t sketched = 1600 * std::uint64_t{shape.columns};
  std::uint64_t known = sketched;
  if (method == "sampled-tour") known += 2800 * std::uint64_t{shape.columns};  // 700 neighbours each
  if (method != "sampled-tour" && !goes_out_of_core(method))
    known = std::uint64_t{shape.rows} * shape.columns / 8;  // as dense bits
  return {matrix + transpose + known, matrix + sketched + transpose / 64};
}

std::uint32_t checksum_of(const VisibilityMatrix& matrix) {
  const std::array parts = {crc32(std::as_bytes(matrix.offsets())), crc32(std::as_bytes(matrix.ids()))};
  return crc32(std::as_bytes(std::span(parts)));
}

// The same matrix a second time.
Dataset read_again(const std::filesystem::path& path, Shape shape, std::uint32_t checksum) {
  const auto refuse = [&](const std::string& how) {
    throw std::runtime_error(path.string() + ": changed while its columns were ordered" + how +
                             "; nothing is written");
  };
  Dataset data;
  try {
    data = read_dataset(path);
  } catch (const std::exception& error) {
    refuse(" (" + std::string(error.what()) + ")");
  }
  if (data.matrix.shape() != shape || checksum_of(data.matrix) != checksum) refuse("");
  return data;
}

// As order_side, with the transpose in a file beside the output and the matrix given up meanwhile.
Result order_out_of_core(Dataset& data, const OrderOptions& options, std::uint64_t needed) {
  const double start = wall_seconds();
  Result result;
  result.runs_before = count_runs(data.matrix);
  const Shape shape = data.matrix.shape();
  const std::uint32_t checksum = checksum_of(data.matrix);
  const auto folder = std::filesystem::absolute(options.out).parent_path();
  const SparsePoints points(data.matrix, folder,
                            std::min<std::uint64_t>(options.memory - needed, 1 << 30) + (1 << 16));
  data = {};
  const auto visits = best_visits(
      points, {.seed = options.order.seed, .seconds = options.order.seconds, .stages = show_progress});
  result.runs_after = runs_of_visits(points, visits);
  result.order = points.order_of_columns(visits);
  result.seconds = wall_seconds() - start;
  if (result.runs_after > result.runs_before) {
    result.order = Permutation::identity(result.order.size());
    result.runs_after = result.runs_before;
  }
  if (options.bound != "none") result.bound = lower_bound(points, visits, options.bound_options()).runs;
  data = read_again(options.in, shape, checksum);
  return result;
}

void print(const char* side, const Result& r) {
  std::printf("%-8s %12ju runs of ones, were %ju (%.1f %% fewer)", side, std::uintmax_t{r.runs_after},
              std::uintmax_t{r.runs_before},
              r.runs_before == 0
                  ? 0.
                  : 100. - 100. * static_cast<double>(r.runs_after) / static_cast<double>(r.runs_before));
  if (r.bound) {
    std::printf("; no order has fewer than %ju: within %.2f %%", std::uintmax_t{*r.bound},
                *r.bound == 0
                    ? 0.
                    : 100. * static_cast<double>(r.runs_after - *r.bound) / static_cast<double>(*r.bound));
  }
  std::printf("; %.2f s\n", r.seconds);
}

nlohmann::json report(const Result& r) {
  nlohmann::json json = {{"runs_before", r.runs_before},
                         {"runs_after", r.runs_after},
                         {"bound", nullptr},
                         {"seconds", r.seconds},
                         {"peak_bytes", peak_bytes()}};
  if (r.bound) json["bound"] = *r.bound;
  return json;
}

void run_order(const OrderOptions& options) {
  if (options.memory != 0 && std::filesystem::exists(options.in) &&
      !std::filesystem::is_regular_file(options.in)) {
    throw std::invalid_argument(options.in.string() +
                                ": is no regular file; --memory may read the matrix twice, which needs one");
  }
  Dataset data = read_matrix(options.in);
  const Shape shape = data.matrix.shape();
  if (options.columns == "identity" && options.rows == "identity") {
    throw std::invalid_argument("nothing to order: give --columns METHOD or --rows METHOD, for example best");
  }
  if (options.symmetric && (shape.rows != shape.columns || options.rows != "identity")) {
    throw std::invalid_argument(
        "--symmetric needs a square matrix and --columns without --rows; this one is " +
        std::to_string(shape.rows) + " x " + std::to_string(shape.columns));
  }
  Permutation rows = Permutation::identity(shape.rows), columns = Permutation::identity(shape.columns);
  std::optional<Result> of_columns, of_rows;
  bool out_of_core = false;
  if (options.memory != 0) {
    if (options.rows != "identity")
      throw std::invalid_argument("--memory is for --columns; order the rows in a second run");
    const Need need = memory_needed(data.matrix, options.columns);
    out_of_core = need.in_core > options.memory;
    const std::uint64_t least = goes_out_of_core(options.columns) ? need.out_of_core : need.in_core;
    if (least > options.memory) {
      throw std::invalid_argument("--memory " + std::to_string(options.memory) + ": " + options.columns +
                                  " needs about " + std::to_string(least) + " bytes here" +
                                  (goes_out_of_core(options.columns) ? "" : "; best goes out of core"));
    }
    if (out_of_core) of_columns = order_out_of_core(data, options, least);
  }
  if (options.columns != "identity") {
    if (!of_columns) of_columns = order_side(data.matrix, options.columns, data, false, options);
    columns = of_columns->order;
    if (options.symmetric) rows = columns;
  }
  if (options.rows != "identity") {
    of_rows = order_side(transpose(data.matrix), options.rows, data, true, options);
    rows = of_rows->order;
  }
  const bool were_nodes = data.source.columns_are_nodes;
  const Dataset result = reordered(std::move(data), rows, columns);
  if (of_columns) print("columns", *of_columns);
  if (of_rows) print("rows", *of_rows);
  if (were_nodes && !result.source.columns_are_nodes) {
    std::printf("the columns were a tree's nodes; in another order they are not, so the tree is left out\n");
  }
  write_matrix(options.out, result);
  if (!options.json.empty()) {
    nlohmann::json json = report(of_columns ? *of_columns : *of_rows);
    if (of_columns && of_rows) json["rows"] = report(*of_rows);
    const std::string text = json.dump(2) + "\n";
    write_file(options.json, std::as_bytes(std::span(text)));
  }
}

}  // namespace

void add_order(Program& program) {
  const auto options = std::make_shared<OrderOptions>();
  options->order.stages = show_progress;
  const Verb verb = program.verb("order", "Reorder rows and columns so that similar ones are neighbours");
  verb.input("MATRIX", options->in, "The matrix file to read (.bsp.h5, .mtx, .npy or .npz)").required();
  verb.output(options->out, Written::matrix, "The matrix file to write; its orders are stored with it");
  verb.option("--columns", options->columns, "Method that orders the columns; see the list below");
  verb.option("--rows", options->rows,
              "Method that orders the rows; also 'neighbours': greedy order among touching view cells");
  verb.flag("--symmetric", options->symmetric,
            "Give the rows of a square matrix the same order as its columns");
  verb.option("--seed", options->order.seed, "Seed of the methods that draw random numbers");
  verb.option("--seconds", options->order.seconds,
              "Improve tours for this long; 0: until a fixed number of changes has been tried")
      .between(0, 1e7);
  verb.option("--bound", options->bound,
              "Lower bound on the number of runs in any order: none, quick (seconds; a minute for 25,000 "
              "columns), or tight")
      .one_of({"none", "quick", "tight"});
  verb.option("--bound-seconds", options->bound_seconds, "Time that --bound tight takes").between(1e-3, 1e7);
  verb.option("--memory", options->memory,
              "Memory for ordering the columns in bytes, such as 12G; 0: no limit. Where it is too little, "
              "best and scale-tour keep the transposed matrix in a temporary file beside the output")
      .size_in_bytes();
  verb.output("--json", options->json, Written::text,
              "Also write the runs, the bound, the seconds and the peak memory to this file");
  std::string methods;
  for (const Reordering& method : reorderings())
    methods += "\n  " + std::string(method.name) + ": " + std::string(method.idea);
  verb.note("Methods:" + methods + "\n\n");
  verb.example("vismat order koth1.bsp.h5 --columns best --rows best -o ordered.bsp.h5");
  verb.runs([options] { run_order(*options); });
}

}  // namespace vismat::cli
