// Measures what a viewer loads at each boundary on a walk: ids that appear and vanish, and their bytes by each codec that reads
// single rows [Chhugani et al. 2005, Figs. 9 and 14].
//
// The walk is runtime/level_walk.h's: through the faces' visibility of levels, or through a matrix that knows its cells' boxes
// and neighbours. The columns are ordered by what appears and vanishes. Both lists of a boundary count. The visible set of each
// view cell on the walk is checked against its row before anything is measured.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/pairs.h"
#include "codecs/rows/row_codec.h"
#include "layout/reordering.h"
#include "matrix/deltas.h"
#include "matrix/files/dataset_file.h"
#include "matrix/files/hdf5_file.h"
#include "programs/csv.h"
#include "programs/names.h"
#include "runtime/difference_walk.h"
#include "runtime/level_walk.h"
#include "visibility/levels/level_file.h"

namespace vismat::bench {
namespace {

struct WalkDeltasOptions {
  std::vector<std::string> inputs, codecs;
  std::string order = "best";
  std::uint32_t steps = 5000;
  std::uint64_t seed = 1;
  std::filesystem::path csv;
};

// Cells with what a walk through them needs.
struct WalkPlace {
  std::string name;
  VisibilityMatrix cells, passages;
  std::vector<Box> cell_boxes, column_boxes;
};

WalkPlace read_place(const std::string& where) {
  if (!is_hdf5(where)) {
    const Level level = read_level(where);
    if (level.face_ids.empty()) throw std::invalid_argument(where + ": a level without faces");
    return {scene_name(level.name), face_visibility(level), passages_of(level), level.cell_bounds,
            level.face_bounds};
  }
  Dataset data = read_dataset(where);
  if (!data.row_neighbours || data.row_bounds.empty())
    throw std::invalid_argument(where + ": a walk needs the rows' boxes and neighbours");
  return {matrix_name(where), std::move(data.matrix), std::move(*data.row_neighbours),
          std::move(data.row_bounds), std::move(data.column_bounds)};
}

// Of each row; where rows share their bytes, all of these.
std::vector<std::uint64_t> bytes_of_rows(const VisibilityMatrix& matrix, const Codec& codec) {
  const Encoded encoded = codec.encode(matrix, {}, {});
  if (decode(codec, encoded, matrix.shape()) != matrix)
    throw std::logic_error(std::string(codec.name) + " does not decode to what it encoded");
  const auto rows = codec.open(Parts(encoded), matrix.shape(), {});
  std::vector<std::uint64_t> bytes(matrix.shape().rows);
  for (std::uint32_t r = 0; r < bytes.size(); ++r) bytes[r] = rows->cost(r).bytes;
  return bytes;
}

std::vector<Codec> chosen_codecs(const std::vector<std::string>& names) {
  std::vector<Codec> codecs;
  for (const std::string& name : names) codecs.push_back(find_codec(name));
  if (names.empty()) codecs = all_codecs();
  std::erase_if(codecs, [](const Codec& codec) { return !codec.rows_alone(); });
  return codecs;
}

void print(const std::string& what, std::vector<std::uint64_t> numbers) {
  std::ranges::sort(numbers);
  const auto at = [&](double share) {
    return static_cast<unsigned long long>(
        numbers[static_cast<std::size_t>(share * static_cast<double>(numbers.size() - 1))]);
  };
  const double count = static_cast<double>(numbers.size());
  const double mean = static_cast<double>(std::reduce(numbers.begin(), numbers.end())) / count;
  const auto small = std::ranges::upper_bound(numbers, std::uint64_t{1024}) - numbers.begin();
  std::printf("  %-20s %9.1f %9llu %9llu %9llu %9.1f\n", what.c_str(), mean, at(.5), at(.9), at(1),
              100 * static_cast<double>(small) / count);
}

void run_walk_deltas(const WalkDeltasOptions& options, const std::string& where,
                     std::span<const Codec> codecs, std::string& csv) {
  const WalkPlace place = read_place(where);
  const auto way = walk_cells(place.passages, place.cell_boxes, options.steps, options.seed);
  Deltas deltas = deltas_of(place.cells, place.passages);
  const auto crossings = crossings_of(deltas, place.cells, way);
  const Permutation columns =
      find_reordering(options.order)
          .order_columns(deltas.lists, {.seed = options.seed, .column_bounds = place.column_boxes});
  deltas.lists = permute(std::move(deltas.lists), Permutation::identity(deltas.lists.shape().rows), columns);

  const std::uint32_t rows = deltas.lists.shape().rows;
  std::vector<std::uint64_t> ids(rows), runs(rows, 0);
  for (std::uint32_t r = 0; r < rows; ++r) {
    ids[r] = deltas.lists.row(r).size();
    for_each_run(deltas.lists.row(r), [&](std::uint32_t, std::uint32_t) { ++runs[r]; });
  }
  std::vector<std::vector<std::uint64_t>> bytes;
  for (const Codec& codec : codecs) bytes.push_back(bytes_of_rows(deltas.lists, codec));
  const auto of_both = [&](std::span<const std::uint64_t> of_row) {
    std::vector<std::uint64_t> sums;
    for (const Crossing& c : crossings) sums.push_back(of_row[c.appears()] + of_row[c.vanishes()]);
    return sums;
  };
  std::printf("%s: %u cells, %u columns in the order %s, %zu boundaries, %.3f %% ones; %zu crossed\n",
              place.name.c_str(), place.cells.shape().rows, place.cells.shape().columns,
              options.order.c_str(), deltas.boundaries.size(), 100 * deltas.lists.density(),
              crossings.size());
  std::printf("  %-20s %9s %9s %9s %9s %9s\n", "in both lists", "mean", "median", "9 of 10", "most",
              "% <= 1024");
  print("ids", of_both(ids));
  print("runs", of_both(runs));
  std::printf("  bytes by\n");
  for (std::size_t k = 0; k < codecs.size(); ++k) print(std::string(codecs[k].name), of_both(bytes[k]));
  std::printf("\n");
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const std::uint32_t appears = crossings[i].appears(), vanishes = crossings[i].vanishes();
    csv += csv_values(place.name, options.order, i + 1, way[i + 1], ids[appears], ids[vanishes],
                      runs[appears] + runs[vanishes]);
    for (const auto& of_row : bytes) csv += "," + csv_values(of_row[appears] + of_row[vanishes]);
    csv += '\n';
  }
}

}  // namespace

void add_walk_deltas(const Verb& verb) {
  const auto o = std::make_shared<WalkDeltasOptions>();
  verb.input("PLACE", o->inputs, "Levels, FILE.bsp or FILE.pk3:maps/NAME.bsp, or matrix files").required();
  verb.option("--codecs", o->codecs,
              "Codecs, named as in 'vismat encode'; all that read single rows if none is named")
      .comma_separated();
  verb.option("--order", o->order, "Order of the columns, named as in 'vismat order'");
  verb.option("--steps", o->steps, "Number of steps from view cell to view cell").positive();
  verb.option("--seed", o->seed, "Seed of the walk and of the order");
  verb.output("--csv", o->csv, Written::text, "File with a line for each step, as CSV");
  verb.example("bench walk-deltas oa_koth1.bsp --codecs delimiter,pair-lzw --csv walk.csv");
  verb.runs([o] {
    const std::vector<Codec> codecs = chosen_codecs(o->codecs);
    std::string csv = "matrix,order,step,cell,appears,vanishes,runs";
    for (const Codec& codec : codecs) csv += "," + std::string(codec.name);
    csv += "\n";
    for (const std::string& input : o->inputs) run_walk_deltas(*o, input, codecs, csv);
    write_table(o->csv, csv);
  });
}

}  // namespace vismat::bench
