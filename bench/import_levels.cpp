// Measures how long importing every level takes: unpacking, parsing, making both matrices and a tree of bounding boxes over each, and
// writing the files, two levels at a time. Before it measures, it checks that oa_koth1 has its known sizes.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/google_benchmark.h"
#include "bench/verbs.h"
#include "matrix/base/parallel.h"
#include "matrix/files/dataset_file.h"
#include "visibility/levels/level_file.h"

namespace vismat::bench {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> levels_under(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto ending = entry.path().extension();
    if (entry.is_regular_file() && !entry.is_symlink() && (ending == ".pk3" || ending == ".wad")) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> levels;
  for (const fs::path& file : files) {
    for (const LevelListing& level : list_levels(file)) levels.push_back(level.where);
  }
  return levels;
}

void check(const std::string& where) {
  const Level level = read_level(where);
  if (level.cells.shape() != Shape{2415, 2415} || face_visibility(level).shape() != Shape{2415, 2200}) {
    throw std::runtime_error(where + ": not 2415 clusters and 2200 faces");
  }
}

// Levels that hold visibility data; one of OpenArena's does not.
void import(benchmark::State& state, const std::vector<std::string>& levels) {
  for (const std::string& where : levels) {
    if (where.ends_with(
            "openarena-081-maps/usr/share/games/openarena/baseoa/pak1-maps.pk3:maps/oa_koth1.bsp")) {
      check(where);
    }
  }
  const fs::path folder = fs::temp_directory_path() / ("vismat-import-" + std::to_string(::getpid()));
  fs::create_directory(folder);
  std::atomic<std::uint64_t> imported = 0, ones = 0;
  for (auto _ : state) {
    imported = ones = 0;
    parallel_for(levels.size(), 2, [&](std::uint64_t i) {
      try {
        const Level level = read_level(levels[i]);
        for (const LevelMatrix matrix : {LevelMatrix::cells, LevelMatrix::faces}) {
          if (matrix == LevelMatrix::faces && level.face_ids.empty()) continue;
          const Dataset dataset = level_dataset(level, matrix, LevelTree::bounds);
          write_dataset(folder / (std::to_string(i) + ".bsp.h5"), dataset);
          ones += dataset.matrix.ones();
        }
        ++imported;
      } catch (const std::runtime_error& error) {
        std::fprintf(stderr, "left out: %s\n", error.what());
      }
    });
  }
  fs::remove_all(folder);
  state.counters["levels"] = static_cast<double>(imported);
  state.counters["visible_pairs"] = static_cast<double>(ones);
}

void run_import_levels() {
  const char* cache = std::getenv("VISMAT_CACHE");
  const fs::path folder = cache != nullptr ? cache : "cache/levels";
  if (!fs::is_directory(folder))
    throw std::invalid_argument("no levels in " + folder.string() + "; run fetch-levels first");
  std::vector<fs::path> packages;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && !entry.path().filename().string().starts_with("."))
      packages.push_back(entry.path());
  }
  std::sort(packages.begin(), packages.end());
  for (const fs::path& package : packages) {
    const auto name = "import/" + package.filename().string();
    benchmark::RegisterBenchmark(name.c_str(), import, levels_under(package))
        ->Iterations(1)
        ->UseRealTime()
        ->Unit(benchmark::kSecond);
  }
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

void add_import_levels(const Verb& verb) {
  verb.note("The levels are those under $VISMAT_CACHE, or cache/levels, as ./fetch-levels leaves them.");
  verb.note(
      "Other arguments are Google Benchmark's: --benchmark_filter=REGEX, --benchmark_repetitions=9, ...");
  verb.example("VISMAT_CACHE=levels bench import-levels");
  verb.runs_with_rest([](const std::vector<std::string>& arguments) {
    start_google_benchmark(arguments, "bench import-levels");
    run_import_levels();
  });
}

}  // namespace vismat::bench
