// Counts the disk reads of a viewer who walks through a level, by the order that its faces have on the disk [Chhugani et al. 2005,
// section 6.1 and Fig. 12].
//
// The walk is runtime/level_walk.h's. In each view cell the faces that are seen and not in memory are read. A face takes the bytes of
// its vertices and indices as a renderer loads them: 44 for each vertex (the level's own record: place, two pairs of texture
// coordinates, normal, colour), 4 for each index, curved faces as the triangles they are drawn with.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "layout/cost.h"
#include "layout/reordering.h"
#include "programs/csv.h"
#include "programs/names.h"
#include "runtime/disk_layout.h"
#include "runtime/level_walk.h"
#include "visibility/levels/level_file.h"

namespace vismat::bench {
namespace {

struct DiskWalkOptions {
  std::vector<std::string> levels;
  std::vector<std::string> layouts = {"identity", "random", "sampled-tour", "best"};
  std::vector<std::uint64_t> pages = {4096, 65536}, ahead = {0, 1, 4};
  std::uint32_t steps = 5000;
  double cache = .25;
  std::uint32_t detail = 1;
  bool whole_sets = false;
  std::uint64_t seed = 1;
  std::filesystem::path csv;
};

constexpr std::uint64_t vertex_bytes = 44, index_bytes = 4;

// Of each face; a face's vertices are its own.
std::vector<std::uint64_t> face_bytes(const Scene& scene, std::uint32_t detail) {
  std::vector<std::uint64_t> bytes(scene.object_count, 0);
  std::vector<bool> counted(scene.vertices.size(), false);
  for (std::size_t i = 0; i < scene.indices.size(); ++i) {
    std::uint64_t& face = bytes[scene.object_of_triangle[i / 3]];
    face += index_bytes;
    if (!counted[scene.indices[i]]) face += vertex_bytes;
    counted[scene.indices[i]] = true;
  }
  for (std::uint64_t& b : bytes) b *= detail;
  return bytes;
}

// What appears where a viewer passes from a cell to the next, one row a passage and direction, as in the paper.
VisibilityMatrix appearing(const VisibilityMatrix& visible, const VisibilityMatrix& passages) {
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t from = 0; from < passages.shape().rows; ++from) {
    for (const std::uint32_t to : passages.row(from)) {
      std::ranges::set_difference(visible.row(to), visible.row(from),
                                  std::back_inserter(rows.emplace_back()));
    }
  }
  return VisibilityMatrix::from_rows(rows, visible.shape().columns);
}

double fewer(std::uint64_t reads, std::uint64_t than) {
  return 100 * (1 - static_cast<double>(reads) / static_cast<double>(std::max<std::uint64_t>(than, 1)));
}

void run_disk_walk(const DiskWalkOptions& options, const std::string& where, std::string& csv) {
  const Level level = read_level(where);
  if (level.face_ids.empty()) throw std::invalid_argument(where + ": a level without faces");
  const VisibilityMatrix visible = face_visibility(level);
  const auto bytes = face_bytes(level.face_scene, options.detail);
  const VisibilityMatrix passages = passages_of(level);
  const auto steps = walk_cells(passages, level.cell_bounds, options.steps, options.seed);
  const VisibilityMatrix deltas = appearing(visible, passages);
  const VisibilityMatrix& ordered_by = options.whole_sets ? visible : deltas;

  std::vector<DiskLayout> layouts;
  std::vector<std::uint64_t> runs;
  for (const std::string& name : options.layouts) {
    const auto order = find_reordering(name).order_columns(
        ordered_by, {.seed = options.seed, .column_bounds = level.face_bounds});
    layouts.emplace_back(bytes, order);
    runs.push_back(count_runs(deltas, order));
  }
  const std::uint64_t total = layouts.front().total_bytes();
  const auto held = static_cast<std::uint64_t>(options.cache * static_cast<double>(total));
  std::printf(
      "%s: %u cells, %u faces of %.2f MB, %.0f bytes each; %zu cells walked through, %.2f MB kept in "
      "memory\n",
      level.name.c_str(), visible.shape().rows, visible.shape().columns, static_cast<double>(total) / 1e6,
      static_cast<double>(total) / visible.shape().columns, steps.size() - 1,
      static_cast<double>(held) / 1e6);
  std::printf("%8s %6s  %-14s %10s %9s %9s %9s %9s %9s\n", "page", "ahead", "layout", "runs", "reads",
              "MB read", "MB wanted", "% fewer", "% fewer");
  std::printf("%8s %6s  %-14s %10s %9s %9s %9s %9s %9s\n", "bytes", "pages", "", "of deltas", "", "", "",
              "than rnd", "than nat");
  for (const std::uint64_t page : options.pages) {
    for (const std::uint64_t ahead : options.ahead) {
      std::vector<DiskReads> counts;
      const auto reads_of = [&](const char* name) {
        const auto place = std::ranges::find(options.layouts, name) - options.layouts.begin();
        return static_cast<std::size_t>(place) < counts.size() ? counts[place].reads : 0;
      };
      for (const DiskLayout& layout : layouts)
        counts.push_back(count_disk_reads(
            layout, visible, steps, {.page_bytes = page, .read_ahead_pages = ahead, .cache_bytes = held}));
      for (std::size_t i = 0; i < counts.size(); ++i) {
        const DiskReads& count = counts[i];
        std::printf("%8llu %6llu  %-14s %10llu %9llu %9.2f %9.2f %9.1f %9.1f\n",
                    static_cast<unsigned long long>(page), static_cast<unsigned long long>(ahead),
                    options.layouts[i].c_str(), static_cast<unsigned long long>(runs[i]),
                    static_cast<unsigned long long>(count.reads), static_cast<double>(count.bytes_read) / 1e6,
                    static_cast<double>(count.bytes_wanted) / 1e6, fewer(count.reads, reads_of("random")),
                    fewer(count.reads, reads_of("identity")));
        csv += csv_line(scene_name(level.name), options.layouts[i], page, ahead, options.steps, count.reads,
                        count.bytes_read, count.bytes_wanted, total, held, runs[i]);
      }
    }
  }
  std::printf("\n");
}

}  // namespace

void add_disk_walk(const Verb& verb) {
  const auto o = std::make_shared<DiskWalkOptions>();
  verb.input("LEVEL", o->levels, "Quake 3 levels, FILE.bsp or FILE.pk3:maps/NAME.bsp").required();
  verb.option("--orders", o->layouts, "Orders of the faces on the disk, named as in 'vismat order'")
      .comma_separated();
  verb.option("--page", o->pages, "Bytes of a page of the disk");
  verb.option("--ahead", o->ahead, "Number of unwanted pages that one read may continue over (read-ahead)");
  verb.option("--steps", o->steps, "Number of steps from view cell to view cell");
  verb.option("--cache", o->cache, "Memory for faces, as a share of the bytes of all faces").between(0., 1.);
  verb.option("--detail", o->detail, "Factor on the bytes of each face, as if meshes were finer").positive();
  verb.flag("--whole-sets", o->whole_sets,
            "Make the orders from what view cells see, not from what appears between them");
  verb.option("--seed", o->seed, "Seed of the walk and of the orders");
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.example("bench disk-walk oa_koth1.bsp --orders random,best --page 4096 --csv walk.csv");
  verb.runs([o] {
    std::string csv =
        "matrix,layout,page_bytes,read_ahead_pages,steps,reads,bytes_read,bytes_wanted,total_bytes,cache_"
        "bytes,runs\n";
    for (const std::string& level : o->levels) run_disk_walk(*o, level, csv);
    write_table(o->csv, csv);
  });
}

}  // namespace vismat::bench
