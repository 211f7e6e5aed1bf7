// Measures the methods and baselines of Zach & Karner 2003 on any matrices, as in their Tables 1 and 2; each is checked by a round
// trip before it is timed.
//
// Writes FOLDER/zach2003_scenes.csv (Table 1) and FOLDER/zach2003.csv (Table 2 and more), a line for each codec and
// row order. Seconds are medians of up to five runs within two seconds.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/tree/tree_coding.h"
#include "layout/orders/greedy_order.h"
#include "matrix/files/dataset_file.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"

namespace vismat::bench {
namespace {

double median_seconds(const std::function<void()>& work) {
  return time_passes({.seconds = 2, .most = 5}, work).median;
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

// The paper's methods, and before them what it compares them with; `vismat compare` has every codec.
std::vector<Codec> codecs_of_tables() {
  std::vector<Codec> codecs;
  for (const char* beside : {"bitmap", "quake-rle", "gzip", "bzip2"}) codecs.push_back(find_codec(beside));
  for (const Codec& codec : own_codecs()) {
    if (codec.needs.tree == TreeOver::columns) codecs.push_back(codec);
  }
  return codecs;
}

struct Measurement {
  Encoded encoded;
  double encode_s = 0, decode_s = 0;
  LengthStatistics lengths;
  double average_run() const {
    return static_cast<double>(lengths.bits) / static_cast<double>(lengths.lengths);
  }
};

// Throws std::logic_error, naming the codec, unless decoding gives the matrix back.
Measurement measure(const Codec& codec, const VisibilityMatrix& matrix, const ObjectTree& tree) {
  const Side side{&tree, {}, {}};
  Measurement m{codec.encode(matrix, side, {}), 0, 0, length_statistics(codec, matrix, &tree)};
  const auto decoded = [&] { return decode(codec, m.encoded, matrix.shape(), side); };
  if (decoded() != matrix) throw std::logic_error(std::string(codec.name) + " does not restore its matrix");
  m.encode_s = median_seconds([&] { codec.encode(matrix, side, {}); });
  m.decode_s = median_seconds(decoded);
  return m;
}

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

// One line of Table 1 and, for each codec and row order, one of Table 2; the latter on the terminal too.
void add_tables(const std::filesystem::path& path, std::string& scenes, std::string& table) {
  Dataset data = read_dataset(path);
  if (data.source.tree && !data.source.columns_are_nodes) data = over_nodes(data);
  if (!data.source.tree)
    throw std::invalid_argument(path.string() + ": has no tree; make one with 'vismat tree --nodes'");
  const std::string name = matrix_name(path);
  const Shape shape = data.matrix.shape();
  scenes += csv_line(name, shape.rows, shape.columns, data.matrix.density(), data.matrix.ones(),
                     to_string(data.guarantee), csv_quoted(data.provenance));
  std::printf("\n%s: %u view cells, %u occludees, average visibility %.1f %%\n", name.c_str(), shape.rows,
              shape.columns, data.matrix.density() * 100);
  std::printf("  %-14s %-11s %12s %8s %10s %10s %9s %9s %9s\n", "method", "cell order", "bytes", "ratio",
              "+ index", "+ order", "avg. run", "enc. ms", "dec. ms");
  for (const Order& order : orders_of(data)) {
    const std::uint64_t order_bytes = order.name == "natural" ? 0 : permutation_bytes(shape.rows);
    for (const Codec& codec : codecs_of_tables()) {
      if (order.name == "neighbours" && !codec.needs.row_order) continue;
      const Measurement m = measure(codec, order.matrix, *data.source.tree);
      const std::size_t bytes = m.encoded.payload.size(), index_bytes = m.encoded.index.size();
      const double ratio = static_cast<double>(bitmap_size(shape)) / static_cast<double>(bytes);
      const bool lengths = m.lengths.lengths > 0;  // of methods that code any
      const std::string run = lengths ? fixed(m.average_run(), 2) : "",
                        entropy = lengths ? fixed(m.lengths.entropy_bytes, 0) : "";
      std::printf("  %-14s %-11s %12zu %7.2fx %10zu %10ju %9s %9.1f %9.1f\n", codec.name.data(),
                  order.name.c_str(), bytes, ratio, index_bytes, std::uintmax_t{order_bytes}, run.c_str(),
                  m.encode_s * 1e3, m.decode_s * 1e3);
      std::fflush(stdout);
      table += csv_line(name, shape.rows, shape.columns, data.matrix.ones(), order.name, codec.name, bytes,
                        ratio, csv_quoted(codec.contents), index_bytes, order_bytes, run, m.encode_s,
                        m.decode_s, order.seconds, entropy);
    }
  }
}

}  // namespace

void add_zach_tables(const Verb& verb) {
  struct Options {
    std::filesystem::path out = "out";
    std::vector<std::filesystem::path> files;
  };
  const auto o = std::make_shared<Options>();
  verb.output("--out", o->out, Written::folder, "Folder for zach2003.csv and zach2003_scenes.csv");
  verb.input("MATRIX", o->files,
             "Matrix files with a tree over the columns, as vismat see or vismat tree writes them")
      .required();
  verb.example("bench zach-tables --out out city32.bsp.h5");
  verb.runs([o] {
    std::string scenes = "matrix,view_cells,occludees,average_visibility,ones,guarantee,provenance\n";
    std::string table =
        "matrix,rows,columns,ones,order,codec,bytes,ratio,payload_contains,index_bytes,order_bytes,average_"
        "run,encode_s,decode_s,seconds_order,entropy_bytes\n";
    for (const auto& file : o->files) add_tables(file, scenes, table);
    write_table(o->out / "zach2003_scenes.csv", scenes);
    write_table(o->out / "zach2003.csv", table);
  });
}

}  // namespace vismat::bench
