// Measures van de Panne and Stewart's search for clusters: size against seconds, on given matrices and on synthetic scenes of growing
// size, each matrix in a process of its own.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "codecs/clusters/panne.h"
#include "codecs/rows/row_codec.h"
#include "matrix/files/dataset_file.h"
#include "matrix/generate.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"

namespace vismat::bench {
namespace {

struct PanneSearchOptions {
  std::vector<std::filesystem::path> matrices;
  std::vector<double> scales;
  double seconds = 60;
  unsigned threads = 0;
  std::uint64_t seed = 1;
  std::filesystem::path csv;
};

// A table as it is after so many seconds of search.
struct SearchPoint {
  double seconds, processor_seconds;
  std::uint64_t bytes, priced_bytes, symbols;
  std::uint32_t clusters, rows, columns;
  std::uint64_t ones, peak_bytes;
};

// Points about 1.15 times as many seconds apart; what they take, to encode and count, is no part of their time.
std::vector<SearchPoint> search(const VisibilityMatrix& matrix, const PanneSearchOptions& options) {
  std::vector<SearchPoint> points;
  double paused = 0, paused_processor = 0, next = 0;
  const double start = wall_seconds(), start_processor = processor_seconds();
  const auto note = [&](const PanneTable& table, bool last) {
    const double now = wall_seconds(), now_processor = processor_seconds();
    const double seconds = now - start - paused;
    if (seconds < next && !last) return;
    next = std::max(seconds * 1.15, seconds + .02);
    const Encoded encoded = encode_panne(matrix, table);
    std::uint64_t symbols = 0;
    std::uint32_t clusters = 0;
    for (std::uint32_t l = 0; l < table.lists().size(); ++l) {
      symbols += table.lists()[l].size();
      clusters += !table.is_row(l) && !table.lists()[l].empty();
    }
    points.push_back({seconds, now_processor - start_processor - paused_processor,
                      encoded.payload.size() + encoded.index.size(), table.price() / (8 * PannePrices::unit),
                      symbols, clusters, matrix.shape().rows, matrix.shape().columns, matrix.ones(),
                      peak_bytes()});
    paused += wall_seconds() - now;
    paused_processor += processor_seconds() - now_processor;
  };
  const PanneTable table =
      search_clusters(matrix, {.seconds = options.seconds,
                               .seed = options.seed,
                               .threads = options.threads,
                               .after_round = [&](const PanneTable& t) { note(t, false); }});
  note(table, true);
  const Encoded encoded = encode_panne(matrix, table);
  const auto back = detail::decode_rows<PanneRows>(Parts(encoded), matrix.shape(), {}, matrix.ones());
  if (back != matrix) throw std::runtime_error("a round trip that ends elsewhere");
  return points;
}

void run_panne_search(const PanneSearchOptions& options) {
  std::string csv =
      "matrix,rows,columns,ones,bitmap,seconds,bytes,clusters,symbols,priced_bytes,processor_seconds,peak_"
      "bytes,threads,seed\n";
  const auto tell = [&](const std::string& name, const std::vector<SearchPoint>& points) {
    for (const SearchPoint& m : points) {
      const std::uint64_t bitmap = std::uint64_t{m.rows} * row_bytes_of(m.columns);
      csv += csv_line(name, m.rows, m.columns, m.ones, bitmap, m.seconds, m.bytes, m.clusters, m.symbols,
                      m.priced_bytes, m.processor_seconds, m.peak_bytes, options.threads, options.seed);
    }
    const SearchPoint &first = points.front(), &last = points.back();
    std::printf("%-28s %7u %7u %10llu %10llu %10llu %7.2f %8.1f %8u\n", name.c_str(), last.rows, last.columns,
                static_cast<unsigned long long>(last.ones), static_cast<unsigned long long>(first.bytes),
                static_cast<unsigned long long>(last.bytes),
                static_cast<double>(first.bytes) / static_cast<double>(last.bytes), last.seconds,
                last.clusters);
    std::fflush(stdout);
    write_table(options.csv, csv);
  };
  std::printf("%-28s %7s %7s %10s %10s %10s %7s %8s %8s\n", "matrix", "rows", "columns", "ones", "without",
              "bytes", "ratio", "seconds", "clusters");
  for (const auto& path : options.matrices) {
    tell(matrix_name(path), apart<SearchPoint>([&] { return search(read_dataset(path).matrix, options); }));
  }
  for (const double scale : options.scales) {
    DeltaSceneOptions scene = power_plant_scene(scale);
    scene.seed = options.seed;
    tell("power-plant-1/" + std::to_string(std::lround(1 / scale)),
         apart<SearchPoint>([&] { return search(generate_delta_scene(scene, options.threads), options); }));
  }
}

}  // namespace

void add_panne_search(const Verb& verb) {
  const auto o = std::make_shared<PanneSearchOptions>();
  verb.input("MATRIX", o->matrices, "Matrix files");
  verb.option("--scale", o->scales, "Also synthetic power plants, at these shares of the paper's size")
      .between(1e-4, 1.);
  verb.option("--seconds", o->seconds,
              "Seconds of the search on each matrix; 0: until little more is found, as codec panne does")
      .between(0, 1e7);
  verb.threads(o->threads);
  verb.option("--seed", o->seed, "Seed of the search and of the power plants");
  verb.output("--csv", o->csv, Written::text, "File for the curves as CSV, a line for each point");
  verb.example("bench panne-search koth1.bsp.h5 --seconds 20 --csv panne.csv");
  verb.runs([o] { run_panne_search(*o); });
}

}  // namespace vismat::bench
