// vismat deltas: turns a matrix into the differences between neighbouring view cells, and back.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "layout/trees/nearest_tree.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat::cli {
namespace {

struct DeltasOptions {
  std::filesystem::path in, out;
  std::string neighbours = "auto";
  bool undo = false;
};

std::string known_neighbours(const Dataset& cells) {
  if (cells.row_neighbours) return "given";
  return cells.row_bounds.empty() ? "tree" : "boxes";
}

VisibilityMatrix neighbours_by(const std::string& method, const Dataset& cells) {
  if (method == "given") {
    if (!cells.row_neighbours)
      throw std::invalid_argument(
          "does not say which view cells are neighbours; use --neighbours boxes or tree");
    return *cells.row_neighbours;
  }
  if (method == "tree") return nearest_tree(cells.matrix, show_progress("nearest rows"));
  if (cells.row_bounds.empty())
    throw std::invalid_argument("has no boxes for its rows; use --neighbours tree");
  return touching_boxes(cells.row_bounds);
}

const char* meaning(const std::string& method) {
  if (method == "given") return "given with the matrix";
  return method == "boxes" ? "by boxes that touch" : "by the spanning tree of nearest rows";
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

void print(const Deltas& deltas, const VisibilityMatrix& cells) {
  const VisibilityMatrix& lists = deltas.lists;
  line("boundaries", summary_of(deltas.boundaries));
  line("lists",
       grouped(lists.shape().rows) + formatted(", %.1f ones each", share(lists.ones(), lists.shape().rows)));
  line("ones", grouped(lists.ones()) +
                   formatted(", %.3f times the view cells' ", share(lists.ones(), cells.ones())) +
                   grouped(cells.ones()));
  line("density",
       formatted("%.3f %%; the view cells' is %.3f %%", 100 * lists.density(), 100 * cells.density()));

  std::vector<std::uint64_t> differences;  // between cells, both ways together
  std::uint64_t empty = 0;
  for (std::uint32_t b = 0; b < deltas.boundaries.size(); ++b) {
    if (deltas.boundaries[b].from == Boundary::outside) continue;
    const std::size_t appears = lists.row(2 * b).size(), vanishes = lists.row(2 * b + 1).size();
    empty += (appears == 0) + (vanishes == 0);
    differences.push_back(appears + vanishes);
  }
  if (differences.empty()) return line("between cells", "nothing: no two view cells are neighbours");
  std::ranges::sort(differences);
  line("between cells",
       formatted("mean %.1f ones, median ",
                 share(std::reduce(differences.begin(), differences.end()), differences.size())) +
           grouped(differences[differences.size() / 2]) + ", at most " + grouped(differences.back()) +
           formatted("; %.1f %% of the lists are empty", 100 * share(empty, 2 * differences.size())));
}

// The same source map: what it says of rows is about the view cells, in a matrix of differences too. The geometry of the rows is
// left out.
Dataset with_rows(const Dataset& of, VisibilityMatrix matrix) {
  Dataset result;
  result.matrix = std::move(matrix);
  result.columns_are = of.columns_are;
  result.provenance = of.provenance;
  result.guarantee = of.guarantee;
  result.seed = of.seed;
  result.column_bounds = of.column_bounds;
  result.source = of.source;
  return result;
}

void make(const DeltasOptions& options) {
  if (!keeps_everything(options.out))
    throw std::invalid_argument(options.out.string() + ": has no place for the boundaries; write .bsp.h5");
  const Dataset cells = read_matrix(options.in);
  const std::string method = options.neighbours == "auto" ? known_neighbours(cells) : options.neighbours;
  Deltas deltas;
  try {
    if (!cells.source.boundaries.empty())
      throw std::invalid_argument("holds differences already; --undo restores the view cells");
    deltas = deltas_of(cells.matrix, neighbours_by(method, cells));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options.in.string() + ": " + error.what());
  }
  Dataset result = with_rows(cells, deltas.lists);
  result.source.boundaries = deltas.boundaries;
  result.rows_are = "boundary list";
  if (!result.provenance.empty()) result.provenance += "; ";
  result.provenance += "differences between neighbours " + std::string(meaning(method));
  write_matrix(options.out, result);
  line("neighbours", meaning(method));
  print(deltas, cells.matrix);
}

void undo(const DeltasOptions& options) {
  Dataset deltas = read_matrix(options.in);
  Dataset cells;
  try {
    if (deltas.source.boundaries.empty() && deltas.matrix.shape().rows > 0)
      throw std::invalid_argument("holds no boundaries; 'vismat deltas' makes them");
    deltas = with_lists_in_place(std::move(deltas));
    const Deltas lists = {std::exchange(deltas.source.boundaries, {}), std::move(deltas.matrix)};
    cells = with_rows(deltas, cells_of(lists));
    cells.row_neighbours = neighbours_of(lists.boundaries);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options.in.string() + ": " + error.what());
  }
  write_matrix(options.out, cells);
}

}  // namespace

void add_deltas(Program& program) {
  const auto options = std::make_shared<DeltasOptions>();
  const Verb verb =
      program.verb("deltas", "Turn a matrix into the differences between neighbouring view cells, or back");
  verb.input(
          "MATRIX", options->in,
          "The matrix file to read (.bsp.h5, .mtx, .npy or .npz); with --undo, a file that this verb wrote")
      .required();
  verb.output(options->out, Written::matrix,
              "The matrix file to write (.bsp.h5), with two rows for each boundary");
  const Option neighbours =
      verb.option("--neighbours", options->neighbours,
                  "Which view cells are neighbours. given: as the matrix file says; boxes: those whose boxes "
                  "share a face; tree: those joined by the spanning tree of nearest rows, whose time grows "
                  "with the square of the number of rows; auto: the first of these that is known")
          .one_of({"given", "boxes", "tree", "auto"});
  verb.flag("--undo", options->undo,
            "Restore the view cells: the same matrix, and which of them are neighbours")
      .excludes(neighbours);
  verb.example("vismat deltas city.bsp.h5 -o differences.bsp.h5");
  verb.example("vismat deltas --undo differences.bsp.h5 -o cells.bsp.h5");
  verb.runs([options] { options->undo ? undo(*options) : make(*options); });
}

}  // namespace vismat::cli
