// compare: every codec on every matrix, in size and in speed.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/progress.h"
#include "cli/verbs.h"
#include "codecs/baseline_codecs.h"
#include "codecs/bitmap.h"
#include "codecs/container.h"
#include "codecs/program_codecs.h"
#include "codecs/row_reader.h"
#include "layout/best_order.h"
#include "layout/distinct_columns.h"
#include "layout/random_order.h"
#include "matrix/atomic_file.h"
#include "matrix/dataset.h"
#include "visibility/bounding_volume_tree.h"

namespace vismat::cli {
namespace {

struct Options {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> orders = {"natural"}, codecs;
  bool distinct = false;
  double seconds = .2;
  std::filesystem::path csv;
};

// A matrix in one order, and what it takes to name that order.
struct Subject {
  std::string matrix, order;
  Dataset data;
  std::optional<Dataset> nodes;  // for codecs over a tree: its nodes keep their order, rows do not
  std::uint64_t permutation_bytes = 0;
};

struct Figures {
  std::uint64_t bytes = 0;
  double encode_s = 0, decode_s = 0;
  std::optional<double> row_p50_us, row_p99_us;
};

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double at_share(std::vector<double>& values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// The median of at least one run and of as many as begin within `seconds`.
template <typename Work>
double median_seconds(double seconds, const Work& work) {
  std::vector<double> times;
  for (const double begin = now(); times.empty() || now() - begin < seconds;) {
    const double start = now();
    work();
    times.push_back(now() - start);
  }
  return at_share(times, .5);
}

// Rows one by one as a viewer asks for them: shuffled, into one buffer, warm.
void measure_rows(const RowReader& reader, const VisibilityMatrix& matrix, double seconds, Figures& figures) {
  const std::uint32_t rows = matrix.shape().rows;
  RowBuffer<std::uint32_t> buffer;
  figures.decode_s = median_seconds(seconds, [&] {
    for (std::uint32_t r = 0; r < rows; ++r) reader.ids(r, buffer);
  });
  if (rows == 0) return;
  const auto shuffled = random_order(rows, 1).old_of_new();
  std::vector<double> clock(1001), times;
  for (double& t : clock) {
    const double start = now();
    t = now() - start;
  }
  const double clock_s = at_share(clock, .5);
  const double begin = now();
  for (std::size_t i = 0; times.size() < 20 || (times.size() < 100000 && now() - begin < seconds); ++i) {
    const double start = now();
    reader.ids(shuffled[i % rows], buffer);
    times.push_back(std::max(0., now() - start - clock_s));
  }
  figures.row_p50_us = 1e6 * at_share(times, .5);
  figures.row_p99_us = 1e6 * at_share(times, .99);
}

Figures measure(const Codec& codec, const Dataset& data, double seconds) {
  const ObjectTree* tree = codec.over_tree == TreeOver::nothing ? nullptr : tree_for(codec, data.source);
  const VisibilityMatrix& matrix = data.matrix;
  Figures figures;
  Container container = compress(matrix, codec, tree);
  figures.bytes = container.encoded.payload.size() + container.encoded.index.size();
  if (decompress(container, codec) != matrix)
    throw std::runtime_error("codec '" + std::string(codec.name) + "' does not restore the matrix");
  figures.encode_s = median_seconds(seconds, [&] { container.encoded = codec.encode(matrix, tree); });
  if (codec.open_rows != nullptr) {
    const auto file = write_container(container);
    measure_rows(RowReader(file, std::span(&codec, 1)), matrix, seconds, figures);
  } else {
    figures.decode_s = median_seconds(seconds, [&] { decompress(container, codec); });
  }
  return figures;
}

std::string name_of(const std::filesystem::path& file) {
  const std::string name = file.filename();
  const std::size_t end = name.find(".bsp.h5");
  return end == std::string::npos ? file.stem().string() : name.substr(0, end);
}

Subject subject_of(const std::filesystem::path& file, const std::string& order, bool distinct) {
  Subject s;
  s.matrix = name_of(file);
  s.order = order;
  s.data = read_dataset(file);
  const auto [rows, columns] = s.data.matrix.shape();
  if (!s.data.source.row_tree && !s.data.row_bounds.empty()) s.data.source.row_tree = bounding_volume_tree(s.data.row_bounds, 2);
  if (distinct) {
    auto kinds = distinct_columns(s.data.matrix);
    s.permutation_bytes += static_cast<std::uint64_t>(
        std::ceil(columns * std::log2(std::max(1u, kinds.matrix.shape().columns)) / 8));
    s.data = {};
    s.data.matrix = std::move(kinds.matrix);
    s.matrix += ", distinct columns";
  }
  if (s.data.source.tree && s.data.source.boundaries.empty()) s.nodes = s.data.source.columns_are_nodes ? s.data : over_nodes(s.data);
  if (order == "best") {
    const Permutation by_columns = best_order(s.data.matrix, {.stages = show_progress}),
                      by_rows = best_order(transpose(s.data.matrix), {.stages = show_progress});
    s.permutation_bytes += permutation_bytes(rows) + permutation_bytes(by_columns.size());
    s.data = reordered(std::move(s.data), by_rows, by_columns);
    if (s.nodes)
      s.nodes =
          reordered(std::move(*s.nodes), by_rows, Permutation::identity(s.nodes->matrix.shape().columns));
  }
  return s;
}

std::vector<Codec> codecs_named(const std::vector<std::string>& names) {
  std::vector<Codec> codecs = all_codecs();
  for (const Codec& codec : program_codecs()) {
    const bool named = std::find(names.begin(), names.end(), codec.name) != names.end();
    if (named || program_available(codec)) codecs.push_back(codec);
  }
  if (names.empty()) return codecs;
  std::vector<Codec> chosen;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(codecs.begin(), codecs.end(), [&](const Codec& c) { return c.name == name; });
    chosen.push_back(found == codecs.end() ? find_codec(name) : *found);  // which throws, listing the names
  }
  return chosen;
}

void print_header(const Subject& s) {
  std::printf("\n%s: %u x %u, %ju ones, bitmap %ju bytes; order %s", s.matrix.c_str(),
              s.data.matrix.shape().rows, s.data.matrix.shape().columns, std::uintmax_t{s.data.matrix.ones()},
              std::uintmax_t{bitmap_size(s.data.matrix.shape())}, s.order.c_str());
  if (s.permutation_bytes > 0)
    std::printf(", %ju bytes to name it, not counted below", std::uintmax_t{s.permutation_bytes});
  std::printf("\n%-20s %12s %9s %9s %10s %12s %9s %10s %10s\n", "codec", "bytes", "ratio", "bits/one",
              "encode s", "decode GB/s", "M ids/s", "row p50 us", "row p99 us");
}

void print(const Subject& s, const Codec& codec, const Figures& f) {
  const auto bitmap = static_cast<double>(bitmap_size(s.data.matrix.shape())),
             ones = static_cast<double>(s.data.matrix.ones()), bytes = static_cast<double>(f.bytes);
  std::printf("%-20s %12ju %8.2fx %9.3f %10.4f %12.3f %9.1f", std::string(codec.name).c_str(),
              std::uintmax_t{f.bytes}, bitmap / std::max(1., bytes), 8 * bytes / std::max(1., ones),
              f.encode_s, bitmap / 1e9 / f.decode_s, ones / 1e6 / f.decode_s);
  if (f.row_p50_us)
    std::printf(" %10.3f %10.3f\n", *f.row_p50_us, *f.row_p99_us);
  else
    std::printf(" %10s %10s\n", "-", "-");
  std::fflush(stdout);
}

void write_csv_line(std::ostringstream& csv, const Subject& s, const Codec& codec, const Figures& f) {
  const Shape shape = s.data.matrix.shape();
  csv << '"' << s.matrix << "\"," << shape.rows << ',' << shape.columns << ',' << s.data.matrix.ones() << ','
      << s.order << ',' << codec.name << ',' << f.bytes << ',' << s.permutation_bytes << ',' << f.encode_s
      << ',' << f.decode_s << ',';
  if (f.row_p50_us)
    csv << *f.row_p50_us << ',' << *f.row_p99_us << '\n';
  else
    csv << ",\n";
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("compare", "Every codec on every matrix: bytes, and how fast they come back");
  verb->add_option("MATRIX", options->files, "Matrix files, .bsp.h5 or .mtx")->required();
  verb->add_option("--orders", options->orders,
                   "natural (as it stands), best (rows and columns as by vismat order), or both")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"natural", "best"}))
      ->capture_default_str();
  verb->add_option("--codecs", options->codecs, "These alone; default: all that there are here")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb->add_flag("--distinct", options->distinct,
                 "Equal columns once; what tells which are equal counts as part of the order");
  verb->add_option("--seconds", options->seconds,
                   "For each figure: runs begin as long as this; the median counts")
      ->capture_default_str();
  verb->add_option("--csv", options->csv, "Also write a table of commas");
  verb->footer(
      "Bytes are payload and index. Codecs that give rows alone decode row by row into one buffer, others "
      "the whole matrix.\n"
      "Every codec is checked by a round trip first. Codecs over a tree want a matrix with a tree, over rows one with boxes or with a tree over them.\n"
      "Example: vismat compare koth1.bsp.h5 --orders natural,best --csv koth1.csv");
  verb->callback([options] {
    const auto codecs = codecs_named(options->codecs);
    std::ostringstream csv;
    csv.precision(6);
    csv << "matrix,rows,columns,ones,order,codec,bytes,permutation_bytes,encode_s,decode_s,row_p50_us,row_"
           "p99_us\n";
    for (const auto& file : options->files) {
      for (const std::string& order : options->orders) {
        const Subject s = subject_of(file, order, options->distinct);
        print_header(s);
        const auto progress = show_progress("codecs");
        std::uint64_t done = 0;
        for (const Codec& codec : codecs) {
          progress(done++, codecs.size());
          if (codec.over_tree == TreeOver::columns && !s.nodes) continue;
          if (codec.over_tree == TreeOver::rows && !s.data.source.row_tree) continue;
          const Figures figures =
              measure(codec, codec.over_tree == TreeOver::columns ? *s.nodes : s.data, options->seconds);
          print(s, codec, figures);
          write_csv_line(csv, s, codec, figures);
        }
      }
    }
    if (options->csv.empty()) return;
    const std::string text = csv.str();
    write_file(options->csv, std::as_bytes(std::span(text)));
  });
}

}  // namespace vismat::cli
