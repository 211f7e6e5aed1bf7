// order: the same matrix with its rows in another order.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "cli/progress.h"
#include "cli/verbs.h"
#include "layout/greedy_order.h"
#include "matrix/dataset.h"

namespace vismat::cli {
namespace {

// Groups of ones down all columns: what the paper's run lengths count.
std::uint64_t runs_down_columns(const VisibilityMatrix& matrix) {
  std::uint64_t runs = 0;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    for (const std::uint32_t c : matrix.row(r)) runs += r == 0 || !matrix.contains(r - 1, c);
  }
  return runs;
}

}  // namespace

void add_order(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
    std::string rows = "greedy";
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("order", "Reorder the rows of a matrix so that similar ones are neighbours");
  verb->add_option("MATRIX", options->in, "Matrix file, .bsp.h5 or .mtx")->required();
  verb->add_option("-o,--output", options->out, "Matrix file to write")->required();
  verb->add_option("--rows", options->rows,
                   "greedy: the most similar row next; neighbours: the same among touching view cells only")
      ->check(CLI::IsMember({"greedy", "neighbours"}))
      ->capture_default_str();
  verb->footer("Example: vismat order city32.bsp.h5 --rows greedy -o city32-ordered.bsp.h5");
  verb->callback([options] {
    const Dataset data = read_dataset(options->in);
    if (options->rows == "neighbours" && !data.row_neighbours) {
      throw std::invalid_argument(options->in.string() +
                                  ": does not say which rows are neighbours; use --rows greedy");
    }
    const auto start = std::chrono::steady_clock::now();
    const Permutation rows = options->rows == "greedy"
                                 ? order_rows_greedily(data.matrix, show_progress("ordering rows"))
                                 : order_rows_by_neighbours(data.matrix, *data.row_neighbours);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const Dataset ordered = with_rows_permuted(data, rows);
    write_dataset(options->out, ordered);
    std::printf("%s: %llu runs of ones down the columns, were %llu; %.2f s\n", options->out.c_str(),
                static_cast<unsigned long long>(runs_down_columns(ordered.matrix)),
                static_cast<unsigned long long>(runs_down_columns(data.matrix)), seconds);
  });
}

}  // namespace vismat::cli
