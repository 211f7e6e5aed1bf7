// vismat compare: measures every codec's size and speed on every matrix.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/baselines/program_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "layout/best_order.h"
#include "layout/orders/random_order.h"
#include "matrix/points/distinct_columns.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"
#include "programs/options.h"
#include "programs/prepared_for.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

struct CompareOptions {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> orders = {"natural"}, codecs;
  bool distinct = false;
  double seconds = .2;
  std::filesystem::path csv;
};

// A matrix in one order, and the bytes that it takes to store that order.
struct Subject {
  std::string matrix, order;
  Dataset data;
  Permutation rows, columns;  // the order
  std::uint64_t permutation_bytes = 0;
};

struct Figures {
  std::uint64_t bytes = 0;
  double encode_s = 0, decode_s = 0;
  std::optional<double> row_p50_us, row_p99_us;
};

// The median of at least one run and of as many as begin within `seconds`.
double median_seconds(double seconds, const std::function<void()>& work) {
  return time_passes({.seconds = seconds, .least = 1}, work).median;
}

double seconds_of_all_rows(const RowReader& reader, double seconds) {
  RowBuffer<std::uint32_t> buffer;
  return median_seconds(seconds, [&] {
    for (std::uint32_t r = 0; r < reader.shape().rows; ++r) reader.ids(r, buffer);
  });
}

// Rows one by one as a viewer asks for them: shuffled, into one buffer, warm.
void measure_rows(const RowReader& reader, double seconds, Figures& figures) {
  const std::uint32_t rows = reader.shape().rows;
  if (rows == 0) return;
  RowBuffer<std::uint32_t> buffer;
  const auto shuffled = random_order(rows, 1).old_of_new();
  std::vector<double> clock(1001), times;
  for (double& t : clock) t = seconds_of([] {});
  const double clock_s = median(clock);
  const double begin = wall_seconds();
  for (std::size_t i = 0; times.size() < 20 || (times.size() < 100000 && wall_seconds() - begin < seconds);
       ++i) {
    const double row_s = seconds_of([&] { reader.ids(shuffled[i % rows], buffer); });
    times.push_back(std::max(0., row_s - clock_s));
  }
  figures.row_p50_us = 1e6 * median(times);
  figures.row_p99_us = 1e6 * quantile(times, .99);
}

VisibilityMatrix in_source_numbers(VisibilityMatrix matrix, const SourceMap& source) {
  Dataset data;
  data.matrix = std::move(matrix);
  data.source = source;
  return vismat::in_source_numbers(std::move(data)).matrix;
}

Figures measure(const Codec& codec, const Dataset& data, const EncodeOptions& options, double seconds) {
  const VisibilityMatrix& matrix = data.matrix;
  const Side side = side_of(codec, data);
  Figures figures;
  Container container = compress(data, codec, options);
  figures.bytes = container.encoded.bytes();
  if (in_source_numbers(decompress(container, codec, side), container.source) !=
      in_source_numbers(matrix, data.source))
    throw std::runtime_error("codec '" + std::string(codec.name) + "' does not restore the matrix");
  figures.encode_s = median_seconds(seconds, [&] { codec.encode(matrix, side, options); });
  const auto by_parts = [&] { return median_seconds(seconds, [&] { decompress(container, codec, side); }); };
  if (codec.open == nullptr) {
    figures.decode_s = by_parts();
    return figures;
  }
  const auto file = write_container(container);
  const RowReader reader(file, std::span(&codec, 1), side);
  figures.decode_s =
      codec.needs.tree == TreeOver::nothing ? seconds_of_all_rows(reader, seconds) : by_parts();
  measure_rows(reader, seconds, figures);
  return figures;
}

Subject subject_of(const std::filesystem::path& file, Dataset data, const std::string& order, bool distinct) {
  Subject s;
  s.matrix = matrix_name(file);
  s.order = order;
  s.data = std::move(data);
  const auto [rows, columns] = s.data.matrix.shape();
  if (distinct) {
    auto kinds = distinct_columns(s.data.matrix);
    s.permutation_bytes += static_cast<std::uint64_t>(
        std::ceil(columns * std::log2(std::max(1u, kinds.matrix.shape().columns)) / 8));
    s.data = {};
    s.data.matrix = std::move(kinds.matrix);
    s.matrix += ", distinct columns";
  }
  s.rows = Permutation::identity(s.data.matrix.shape().rows);
  s.columns = Permutation::identity(s.data.matrix.shape().columns);
  if (order == "best") {
    s.columns = best_order(s.data.matrix, {.stages = show_progress});
    s.rows = best_order(transpose(s.data.matrix), {.stages = show_progress});
    s.permutation_bytes += permutation_bytes(rows) + permutation_bytes(s.columns.size());
  }
  return s;
}

// Prepared for the codec, then put in the order; where columns are nodes, only the rows are. A codec that wants equal rows once
// and has its own order of rows gets both.
Dataset prepared(const Subject& s, const Codec& codec) {
  if (codec.needs.distinct) return prepared_for(codec, s.data, {.orders = s.order == "best"});
  Dataset data = prepared_for(codec, s.data, {.orders = false});
  if (codec.needs.tree != TreeOver::columns) return reordered(std::move(data), s.rows, s.columns);
  const Permutation as_is = Permutation::identity(data.matrix.shape().columns);
  return reordered(std::move(data), s.rows, as_is);
}

std::vector<Codec> chosen_codecs(const std::vector<std::string>& names) {
  std::vector<Codec> chosen;
  for (const std::string& name : names) {
    const Codec* const program = codec_named(name, program_codecs());
    chosen.push_back(program != nullptr ? *program : find_codec(name));  // which throws, listing the names
  }
  if (!names.empty()) return chosen;
  chosen = all_codecs();
  for (const Codec& codec : available_program_codecs()) chosen.push_back(codec);
  return chosen;
}

void print_header(const Subject& s) {
  std::printf("\n%s: %u x %u, %ju ones, bitmap %ju bytes; order %s", s.matrix.c_str(),
              s.data.matrix.shape().rows, s.data.matrix.shape().columns, std::uintmax_t{s.data.matrix.ones()},
              std::uintmax_t{bitmap_size(s.data.matrix.shape())}, s.order.c_str());
  if (s.permutation_bytes > 0)
    std::printf(", which takes %ju bytes to store; they are not counted below",
                std::uintmax_t{s.permutation_bytes});
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

std::string line_of(const Subject& s, const Codec& codec, const Figures& f) {
  const Shape shape = s.data.matrix.shape();
  const auto text = [](const std::optional<double>& us) { return us ? CsvValue(*us) : CsvValue(""); };
  return csv_line(csv_quoted(s.matrix), shape.rows, shape.columns, s.data.matrix.ones(), s.order, codec.name,
                  to_string(codec.origin), f.bytes, s.permutation_bytes, f.encode_s, f.decode_s,
                  text(f.row_p50_us), text(f.row_p99_us));
}

void run_compare(const CompareOptions& options) {
  const auto codecs = chosen_codecs(options.codecs);
  std::string csv =
      "matrix,rows,columns,ones,order,codec,origin,bytes,permutation_bytes,encode_s,decode_s,row_p50_us,"
      "row_p99_us\n";
  for (const auto& file : options.files) {
    Dataset data = read_matrix(file);  // once, or it might be another one by the next order
    for (const std::string& order : options.orders) {
      const bool last = &order == &options.orders.back();
      const Subject s = subject_of(file, last ? std::move(data) : data, order, options.distinct);
      print_header(s);
      const auto progress = show_progress("codecs");
      std::uint64_t done = 0;
      for (const Codec& codec : codecs) {
        progress(done++, codecs.size());
        if (!obstacle(codec, s.data).empty()) continue;
        const Figures figures =
            measure(codec, prepared(s, codec), {.rows_may_move = s.order == "best"}, options.seconds);
        print(s, codec, figures);
        csv += line_of(s, codec, figures);
      }
    }
  }
  write_table(options.csv, csv);
}

}  // namespace

void add_compare(Program& program) {
  const auto options = std::make_shared<CompareOptions>();
  const Verb verb = program.verb(
      "compare", "Measure every codec on every matrix: the compressed size and the decoding speed");
  verb.input("MATRIX", options->files, "The matrix files (.bsp.h5, .mtx, .npy or .npz)").required();
  verb.option("--orders", options->orders,
              "natural (as it is in the file), best (rows and columns as 'vismat order' puts them), or both")
      .comma_separated()
      .one_of({"natural", "best"});
  verb.option("--codecs", options->codecs, "Only these codecs (default: all that are available)")
      .comma_separated();
  verb.flag("--distinct", options->distinct,
            "Keep one of each set of equal columns; which are equal counts as part of the order's size");
  verb.option(
          "--seconds", options->seconds,
          "Seconds for each measurement: passes are repeated until this time is over, and the median time of "
          "a pass is reported")
      .between(0, 1e7);
  verb.output("--csv", options->csv, Written::text, "Also write the figures as a table (.csv)");
  verb.note(
      "Sizes are those of the payload, the index and the model's sections. Codecs that decode single rows "
      "are timed row by row into one buffer; others, and those over a tree, decode the whole matrix.\n"
      "A round trip checks each codec first. Codecs over a tree of columns need a matrix with such a tree; "
      "those over a tree of rows need one with row boxes or with such a tree.");
  verb.example("vismat compare koth1.bsp.h5 --orders natural,best --csv koth1.csv");
  verb.runs([options] { run_compare(*options); });
}

}  // namespace vismat::cli
