// Tables 1 and 2 of Zach & Karner 2003 for any matrices: every codec, checked by a round trip before it is
// timed.
//
//   zach_tables --out FOLDER MATRIX.bsp.h5 ...
//
// Writes FOLDER/zach2003_scenes.csv (Table 1) and FOLDER/zach2003.csv (Table 2 and more), a line a codec and
// row order. Seconds are medians of up to five runs within two seconds.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "codecs/baseline_codecs.h"
#include "codecs/bitmap.h"
#include "codecs/tree_coding.h"
#include "layout/greedy_order.h"
#include "matrix/atomic_file.h"
#include "matrix/dataset.h"

namespace {

using namespace vismat;

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median_seconds(const auto& work) {
  std::vector<double> runs;
  for (double spent = 0; runs.size() < 5 && (runs.size() < 3 || spent < 2); spent += runs.back())
    runs.push_back(seconds_of(work));
  std::nth_element(runs.begin(), runs.begin() + runs.size() / 2, runs.end());
  return runs[runs.size() / 2];
}

std::string quoted(std::string text) {
  for (std::size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) text.insert(i, 1, '"');
  return '"' + text + '"';
}

std::string format(const char* pattern, auto... values) {
  std::string text(std::size_t(std::snprintf(nullptr, 0, pattern, values...)), '\0');
  std::snprintf(text.data(), text.size() + 1, pattern, values...);
  return text;
}

std::string name_of(const std::filesystem::path& path) {
  std::string name = path.filename();
  return name.substr(0, name.find(".bsp.h5"));
}

struct Order {
  std::string name;
  VisibilityMatrix matrix;
  double seconds = 0;
};

std::vector<Order> orders_of(const Dataset& data) {
  std::vector<Order> orders = {{"natural", data.matrix}};
  const auto add = [&](const char* name, const auto& order_rows) {
    Permutation rows;
    const double seconds = seconds_of([&] { rows = order_rows(); });
    orders.push_back(
        {name, permute(data.matrix, rows, Permutation::identity(data.matrix.shape().columns)), seconds});
  };
  add("greedy", [&] { return order_rows_greedily(data.matrix); });
  if (data.row_neighbours)
    add("neighbours", [&] { return order_rows_by_neighbours(data.matrix, *data.row_neighbours); });
  return orders;
}

void measure(const std::filesystem::path& path, std::string& scenes, std::string& table) {
  Dataset data = read_dataset(path);
  if (data.tree && !data.columns_are_nodes) data = over_nodes(data);
  if (!data.tree)
    throw std::invalid_argument(path.string() + ": has no tree; make one with 'vismat tree --nodes'");
  const std::string name = name_of(path);
  const Shape shape = data.matrix.shape();
  scenes += format("%s,%u,%u,%.6f,%llu,%s,%s\n", name.c_str(), shape.rows, shape.columns,
                   data.matrix.density(), static_cast<unsigned long long>(data.matrix.ones()),
                   std::string(to_string(data.guarantee)).c_str(), quoted(data.provenance).c_str());
  std::printf("\n%s: %u view cells, %u occludees, average visibility %.1f %%\n", name.c_str(), shape.rows,
              shape.columns, data.matrix.density() * 100);
  std::printf("  %-14s %-11s %12s %8s %10s %10s %9s %9s %9s\n", "method", "cell order", "bytes", "ratio",
              "+ index", "+ order", "avg. run", "enc. ms", "dec. ms");
  for (const Order& order : orders_of(data)) {
    const std::uint64_t order_bytes = order.name == "natural" ? 0 : permutation_bytes(shape.rows);
    for (const Codec& codec : all_codecs()) {
      if (order.name == "neighbours" && !codec.wants_row_order) continue;
      const ObjectTree* tree = &*data.tree;
      const Encoded encoded = codec.encode(order.matrix, tree);
      const auto decode = [&] { return codec.decode(encoded.payload, encoded.node_index, shape, tree); };
      if (decode() != order.matrix)
        throw std::logic_error(std::string(codec.name) + " does not restore " + path.string());
      const double encode_s = median_seconds([&] { codec.encode(order.matrix, tree); });
      const double decode_s = median_seconds(decode);
      const LengthStatistics lengths = length_statistics(codec, order.matrix, tree);
      const double average_run =
          lengths.lengths == 0 ? 0 : static_cast<double>(lengths.bits) / static_cast<double>(lengths.lengths);
      const double ratio =
          static_cast<double>(bitmap_size(shape)) / static_cast<double>(encoded.payload.size());
      const std::string run = average_run > 0 ? format("%.2f", average_run) : "";
      std::printf("  %-14s %-11s %12zu %7.2fx %10zu %10llu %9s %9.1f %9.1f\n",
                  std::string(codec.name).c_str(), order.name.c_str(), encoded.payload.size(), ratio,
                  encoded.node_index.size(), static_cast<unsigned long long>(order_bytes), run.c_str(),
                  encode_s * 1e3, decode_s * 1e3);
      table +=
          format("%s,%u,%u,%llu,%s,%s,%zu,%.4f,%s,%zu,%llu,%s,%.6f,%.6f,%.3f,%s\n", name.c_str(), shape.rows,
                 shape.columns, static_cast<unsigned long long>(data.matrix.ones()), order.name.c_str(),
                 std::string(codec.name).c_str(), encoded.payload.size(), ratio,
                 quoted(std::string(codec.contents)).c_str(), encoded.node_index.size(),
                 static_cast<unsigned long long>(order_bytes), run.c_str(), encode_s, decode_s, order.seconds,
                 lengths.lengths == 0 ? "" : format("%.0f", lengths.entropy_bytes).c_str());
    }
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Tables 1 and 2 of Zach & Karner 2003 for any matrices over a tree.");
  std::filesystem::path out = "out";
  std::vector<std::filesystem::path> files;
  app.add_option("--out", out, "Folder for zach2003.csv and zach2003_scenes.csv")->capture_default_str();
  app.add_option("matrices", files, "Matrix files with a tree")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    std::string scenes = "matrix,view_cells,occludees,average_visibility,ones,guarantee,provenance\n";
    std::string table =
        "matrix,rows,columns,ones,order,codec,bytes,ratio,payload_contains,index_bytes,order_bytes,average_"
        "run,encode_s,"
        "decode_s,seconds_order,entropy_bytes\n";
    for (const auto& file : files) measure(file, scenes, table);
    write_file(out / "zach2003_scenes.csv", std::as_bytes(std::span(scenes)));
    write_file(out / "zach2003.csv", std::as_bytes(std::span(table)));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "zach_tables: %s\n", error.what());
    return 1;
  }
  return 0;
}
