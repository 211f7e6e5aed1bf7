// Measures where merging fails: seeds that differ, matrices whose rows have nothing in common, dense rows, single view cells that
// lose most, and trees whose nodes are merged as if they were objects.
//
// Every merge is compared with its source row by row, and every coded matrix is read again. Bytes are those of zach3-range over nodes
// and of pair-ans over objects, without the maps of rows and columns, as in `bench lossy-tables`.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/lossy_merge.h"
#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "matrix/base/random.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"
#include "programs/progress.h"

namespace vismat::bench {
namespace {

struct LossyFailuresOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out = "out/lossy";
  double lost = .05;
  unsigned seeds = 20;
  std::uint32_t size = 2000;
};

struct Subject {
  std::string name;
  Dataset data;
};

Code code_of(const Merge& merge, const VisibilityMatrix& original) {
  return bench::code_of(find_codec(merge.data.source.columns_are_nodes ? "zach3-range" : "pair-ans"), merge,
                        original);
}

// ---- seeds -------------------------------------------------------------------------------------------------------------

std::string seeds(const std::vector<Subject>& subjects, const LossyFailuresOptions& options) {
  std::string csv = "matrix,method,seed,cells,bytes,names_bytes,cell_95,cell_worst,merge_s\n";
  for (const auto& [name, data] : subjects) {
    const auto add = [&](const char* method, unsigned seed) {
      const Merge merge = merge_of(data, MergeSide::rows, find_grouping(method),
                                   options_of(data.matrix, options.lost, 1, seed));
      csv += csv_line(name, method, seed, merge.data.matrix.shape().rows, code_of(merge, data.matrix).bytes,
                      merge.names_bytes, merge.lost_at(.95), merge.lost_at(1), merge.merge_s);
    };
    const auto progress = cli::show_progress(name + ": seeds");
    add("pairs", 1);
    for (unsigned seed = 1; seed <= options.seeds; ++seed) {
      add("seeds", seed);
      progress(seed, options.seeds);
    }
  }
  return csv;
}

// ---- nothing in common -------------------------------------------------------------------------------------------------

VisibilityMatrix random_matrix(std::uint32_t size, double density, std::uint64_t seed) {
  std::vector<std::vector<std::uint32_t>> rows(size);
  Random random(seed);
  for (auto& row : rows) {
    for (std::uint32_t c = 0; c < size; ++c) {
      if (random.fraction() < density) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, size);
}

// The given matrices beside them: cells, and bytes before and after. Random ones stay in their order, for none is better.
std::string without_structure(const std::vector<Subject>& subjects, const LossyFailuresOptions& options) {
  std::string csv =
      "matrix,rows,density,cells,lost_share,added_share,bytes_before,bytes,cell_95,cell_worst\n";
  const auto add = [&](const std::string& name, const Dataset& data, Ordered ordered) {
    const Merge merge = merge_of(data, MergeSide::rows, find_grouping("pairs"),
                                 options_of(data.matrix, options.lost), ordered);
    csv += csv_line(name, data.matrix.shape().rows, data.matrix.density(), merge.data.matrix.shape().rows,
                    merge.loss.lost(), merge.loss.added_share(),
                    code_of(without_merge(data, ordered), data.matrix).bytes,
                    code_of(merge, data.matrix).bytes, merge.lost_at(.95), merge.lost_at(1));
  };
  constexpr double densities[] = {.002, .005, .01, .02, .05, .1, .2, .5, .8};
  const auto progress = cli::show_progress("random matrices");
  for (std::size_t i = 0; i < std::size(densities); ++i) {
    Dataset data;
    data.matrix = random_matrix(options.size, densities[i], 1);
    add("random", data, Ordered::no);
    progress(i + 1, std::size(densities));
  }
  for (const auto& [name, data] : subjects) add(name, data, Ordered::yes);
  return csv;
}

// ---- dense rows --------------------------------------------------------------------------------------------------------

struct DenseRows {
  VisibilityMatrix matrix;
  std::vector<char> added;  // whether a row is one of those
};

// `dense` more rows than there were, spread over the others, each with this share of ones at random.
DenseRows with_dense_rows(const VisibilityMatrix& matrix, std::uint32_t dense, double share) {
  const auto [rows, columns] = matrix.shape();
  std::vector<std::vector<std::uint32_t>> result;
  std::vector<char> added;
  Random random(1);
  std::uint32_t placed = 0;
  for (std::uint32_t r = 0; r < rows; ++r) {
    result.emplace_back(matrix.row(r).begin(), matrix.row(r).end());
    added.push_back(0);
    for (; std::uint64_t{placed} * rows < std::uint64_t{r + 1} * dense; ++placed) {
      result.emplace_back();
      added.push_back(1);
      for (std::uint32_t c = 0; c < columns; ++c) {
        if (random.fraction() < share) result.back().push_back(c);
      }
    }
  }
  return {VisibilityMatrix::from_rows(result, columns), std::move(added)};
}

// A cell is poisoned where it lost more than half of what it hid. Seeds draw their pairs at random, so they are shown too.
std::string dense_rows(const std::vector<Subject>& subjects, const LossyFailuresOptions& options) {
  std::string csv =
      "matrix,dense,share,method,max_per_cell,lost,cells,lost_share,bytes,poisoned,cell_median,cell_95,cell_"
      "worst\n";
  for (const auto& [name, data] : subjects) {
    if (data.source.columns_are_nodes) continue;  // a random row is not monotone over a tree
    const auto add = [&](std::uint32_t dense, double share, const char* method, double max_per_cell,
                         double lost) {
      Dataset with;
      const DenseRows rows = with_dense_rows(data.matrix, dense, share);
      with.matrix = rows.matrix;
      const Merge merge =
          merge_of(with, MergeSide::rows, find_grouping(method), options_of(with.matrix, lost, max_per_cell));
      std::uint32_t poisoned = 0;
      for (std::uint32_t r = 0; r < rows.added.size(); ++r)
        poisoned += !rows.added[r] && merge.loss.lost_in(r) > .5;
      csv += csv_line(name, dense, share, method, max_per_cell, lost, merge.data.matrix.shape().rows,
                      merge.loss.lost(), code_of(merge, with.matrix).bytes, poisoned, merge.lost_at(.5),
                      merge.lost_at(.95), merge.lost_at(1));
    };
    const auto progress = cli::show_progress(name + ": dense rows");
    const std::uint32_t many = std::max(2u, data.matrix.shape().rows / 20);
    std::uint64_t done = 0;
    for (const double lost : {options.lost, 4 * options.lost}) {
      for (const char* method : {"pairs", "seeds"}) {
        add(0, 1, method, 1, lost);
        if (method == std::string("pairs")) add(0, 1, method, .2, lost);
        for (const double share : {.9, 1.}) {
          for (const std::uint32_t dense : {1u, many}) {
            add(dense, share, method, 1, lost);
            if (method == std::string("pairs")) add(dense, share, method, .2, lost);
          }
        }
        progress(++done, 4);
      }
    }
  }
  return csv;
}

// ---- who pays ----------------------------------------------------------------------------------------------------------

// `quantiles`: how much of its own zeros each part of the cells lost, at most.
std::string cells(const std::vector<Subject>& subjects, const LossyFailuresOptions& options,
                  std::string& quantiles) {
  std::string csv =
      "matrix,max_per_cell,cells,lost_share,bytes,names_bytes,cell_median,cell_95,cell_worst,merge_s\n";
  quantiles = "matrix,max_per_cell,share_of_cells,lost\n";
  for (const auto& [name, data] : subjects) {
    for (const double most : {1., .5, .2, .1, .05}) {
      const Merge merge = merge_of(data, MergeSide::rows, find_grouping("pairs"),
                                   options_of(data.matrix, options.lost, most));
      csv += csv_line(name, most, merge.data.matrix.shape().rows, merge.loss.lost(),
                      code_of(merge, data.matrix).bytes, merge.names_bytes, merge.lost_at(.5),
                      merge.lost_at(.95), merge.lost_at(1), merge.merge_s);
      for (unsigned percent = 0; percent <= 100; ++percent)
        quantiles += csv_line(name, most, percent / 100., merge.lost_at(percent / 100.));
    }
  }
  return csv;
}

// ---- trees -------------------------------------------------------------------------------------------------------------

// A child that is visible from a cell that does not see its parent.
std::uint64_t violations(const VisibilityMatrix& nodes, const ObjectTree& tree) {
  std::uint64_t sum = 0;
  for (std::uint32_t r = 0; r < nodes.shape().rows; ++r) {
    for (const std::uint32_t node : nodes.row(r)) {
      const std::uint32_t parent = tree.parent_of_node()[node];
      sum += parent != ObjectTree::none && !nodes.contains(r, parent);
    }
  }
  return sum;
}

// Each node visible where any of its children is: children come after their parents.
VisibilityMatrix with_ancestors(const VisibilityMatrix& nodes, const ObjectTree& tree) {
  std::vector<std::vector<std::uint32_t>> rows(nodes.shape().rows);
  for (std::uint32_t r = 0; r < nodes.shape().rows; ++r) {
    std::vector<char> visible(tree.size(), 0);
    for (const std::uint32_t node : nodes.row(r)) visible[node] = 1;
    for (std::uint32_t node = tree.size(); node-- > 1;) {
      if (visible[node]) visible[tree.parent_of_node()[node]] = 1;
    }
    for (std::uint32_t node = 0; node < tree.size(); ++node) {
      if (visible[node]) rows[r].push_back(node);
    }
  }
  return VisibilityMatrix::from_rows(rows, tree.size());
}

// The objects' columns, out of those of nodes that hold them.
VisibilityMatrix objects_of(const VisibilityMatrix& nodes, const ObjectTree& tree) {
  std::vector<std::uint32_t> node_of_object(tree.object_count(), ObjectTree::none);
  for (std::uint32_t node = 0; node < tree.size(); ++node) {
    const std::uint32_t object = tree.object_of_node()[node];
    if (object != ObjectTree::none && tree.children(node).empty()) node_of_object[object] = node;
  }
  const VisibilityMatrix by_node = transpose(nodes);
  std::vector<std::vector<std::uint32_t>> columns(tree.object_count());
  for (std::uint32_t object = 0; object < tree.object_count(); ++object) {
    if (node_of_object[object] == ObjectTree::none) continue;
    const auto cells = by_node.row(node_of_object[object]);
    columns[object].assign(cells.begin(), cells.end());
  }
  return transpose(VisibilityMatrix::from_rows(columns, nodes.shape().rows));
}

std::string trees(const std::vector<Subject>& subjects, const LossyFailuresOptions& options) {
  std::string csv =
      "matrix,way,lost,columns_left,cells_left,added,added_share,violations,cells_with_violations\n";
  for (const auto& [name, data] : subjects) {
    if (!data.source.columns_are_nodes) continue;
    const ObjectTree& tree = *data.source.tree;
    const Grouping& pairs = find_grouping("pairs");
    for (const double lost : {.01, options.lost}) {
      const auto add = [&](const char* way, const VisibilityMatrix& lossy, std::uint32_t columns,
                           std::uint32_t rows) {
        const Loss loss = proven(loss_of(lossy, data.matrix));
        const std::uint64_t broken = violations(lossy, tree);
        if ((broken == 0) != is_monotone(lossy, tree))
          throw std::runtime_error("violations are counted wrongly");
        std::uint64_t cells_broken = 0;
        for (std::uint32_t r = 0; broken > 0 && r < lossy.shape().rows; ++r) {
          const auto row = lossy.row(r);
          cells_broken += std::any_of(row.begin(), row.end(), [&](std::uint32_t node) {
            const std::uint32_t parent = tree.parent_of_node()[node];
            return parent != ObjectTree::none && !lossy.contains(r, parent);
          });
        }
        csv += csv_line(name, way, lost, columns, rows, loss.added, loss.added_share(), broken, cells_broken);
        return broken;
      };
      const std::uint32_t rows = data.matrix.shape().rows;
      {
        Dataset columns;  // as if they were not nodes
        columns.matrix = data.matrix;
        const Merge merge = merge_of(columns, MergeSide::columns, pairs, options_of(data.matrix, lost));
        const VisibilityMatrix naive = in_source_numbers(merge.data).matrix;
        const std::uint32_t left = merge.data.matrix.shape().columns;
        add("nodes merged", naive, left, rows);
        if (add("nodes merged; ancestors added", with_ancestors(naive, tree), left, rows) > 0)
          throw std::runtime_error("ancestors do not repair a tree");
      }
      {
        const VisibilityMatrix objects = objects_of(data.matrix, tree);
        if (nodes_from_objects(objects, tree) != data.matrix)
          continue;  // nodes that see more than their objects do
        Dataset of_objects;
        of_objects.matrix = objects;
        const Merge merge = merge_of(of_objects, MergeSide::columns, pairs, options_of(objects, lost));
        const VisibilityMatrix nodes = nodes_from_objects(in_source_numbers(merge.data).matrix, tree);
        if (add("objects merged; tree over them", nodes, merge.data.matrix.shape().columns, rows) > 0)
          throw std::runtime_error("objects in a tree break it");
      }
      {
        const Merge merge = merge_of(data, MergeSide::rows, pairs, options_of(data.matrix, lost));
        if (add("cells merged", in_source_numbers(merge.data).matrix, tree.size(),
                merge.data.matrix.shape().rows) > 0)
          throw std::runtime_error("merged cells break a tree");
      }
    }
  }
  return csv;
}

// ---- all of it ---------------------------------------------------------------------------------------------------------

// The table as it stands in the file, in columns.
void print_table(const std::string& csv) {
  std::vector<std::vector<std::string>> lines(1, {""});
  for (const char c : csv) {
    if (c == '\n') {
      lines.push_back({""});
    } else if (c == ',') {
      lines.back().push_back("");
    } else {
      lines.back().back() += c;
    }
  }
  lines.pop_back();
  std::vector<int> widths(lines.front().size(), 0);
  for (auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (const std::size_t dot = line[i].find('.');
          dot != std::string::npos && i > 0 && dot + 5 < line[i].size())
        line[i].resize(dot + 5);
      widths[i] = std::max(widths[i], static_cast<int>(line[i].size()));
    }
  }
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i)
      std::printf(i < 2 ? "  %-*s" : "  %*s", widths[i], line[i].c_str());
    std::printf("\n");
  }
}

void run_lossy_failures(const LossyFailuresOptions& options) {
  std::vector<Subject> subjects;
  for (const auto& file : options.files) subjects.push_back({matrix_name(file), read_matrix(file)});
  const auto tell = [&](const char* file, const std::string& csv, double start) {
    write_table(options.out / file, csv);
    std::printf("\n%s (%.1f s)\n", file, wall_seconds() - start);
    print_table(csv);
    std::fflush(stdout);
  };
  double start = wall_seconds();
  tell("failures_seeds.csv", seeds(subjects, options), start);
  start = wall_seconds();
  tell("failures_random.csv", without_structure(subjects, options), start);
  start = wall_seconds();
  tell("failures_dense.csv", dense_rows(subjects, options), start);
  start = wall_seconds();
  std::string quantiles;
  tell("failures_cells.csv", cells(subjects, options, quantiles), start);
  write_table(options.out / "failures_quantiles.csv", quantiles);
  start = wall_seconds();
  tell("failures_trees.csv", trees(subjects, options), start);
}

}  // namespace

void add_lossy_failures(const Verb& verb) {
  const auto o = std::make_shared<LossyFailuresOptions>();
  verb.output("--out", o->out, Written::folder, "Folder for the tables");
  verb.option("--lost", o->lost, "Share of the occlusions that merging may lose").between(0., .25);
  verb.option("--seeds", o->seeds, "Number of seeds that the paper's method is run with").between(1u, 1000u);
  verb.option("--size", o->size, "Number of rows, and of columns, of the random matrices")
      .between(10u, 100'000u);
  verb.input("MATRIX", o->files, "Matrix files");
  verb.example("bench lossy-failures --out out koth1.bsp.h5");
  verb.runs([o] { run_lossy_failures(*o); });
}

}  // namespace vismat::bench
