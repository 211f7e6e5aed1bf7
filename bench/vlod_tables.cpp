// Measures differences between neighbouring view cells, compressed as Chhugani et al. 2005 do and otherwise: their Table 2.
//
// A difference is one row of a matrix, or two where the file has boundaries (what appears, what vanishes). Bytes are the
// lists' own, with the models that they share and without an index, as the paper counts. The paper does not say in what form LZW
// got the pairs: pair-lzw takes varints, "lzw of 32 bits" takes the numbers of 32 bits that the paper's ratio of 9 to bit masks
// assumes (counted, not timed). Each code is checked by a round trip. Times are the median, the least and the most of several
// passes over all differences in the order of the file.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/rows/pairs.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "layout/best_order.h"
#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "layout/tours/sampled_tour.h"
#include "matrix/files/dataset_file.h"
#include "matrix/generate.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"

namespace vismat::bench {
namespace {

struct VlodTablesOptions {
  std::vector<std::filesystem::path> files;
  std::vector<double> scales;
  std::vector<std::string> orders = {"random", "printed", "best"};
  std::vector<std::string> codes = {"delimiter",  "pair-huffman", "pair-huffman-shared", "pair-lzw",
                                    "pair-gamma", "pair-delta",   "pair-rice",           "pair-interpolative",
                                    "pair-ans",   "streamvbyte",  "elias-fano",          "roaring"};
  double seconds = .5;
  std::filesystem::path csv;
};

struct DeltaMatrix {
  std::string name;
  VisibilityMatrix lists;
  std::uint32_t lists_of_difference = 1;
};

// Whole rows, which lead into a view cell from outside, are no differences.
DeltaMatrix read(const std::filesystem::path& file) {
  const Dataset data = with_lists_in_place(read_dataset(file));
  if (data.source.boundaries.empty()) return {matrix_name(file), data.matrix};
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> ids;
  for (std::size_t b = 0; b < data.source.boundaries.size(); ++b) {
    if (data.source.boundaries[b].from == Boundary::outside) continue;
    for (const std::size_t list : {2 * b, 2 * b + 1}) {
      const auto row = data.matrix.row(static_cast<std::uint32_t>(list));
      ids.insert(ids.end(), row.begin(), row.end());
      offsets.push_back(ids.size());
    }
  }
  const auto lists = static_cast<std::uint32_t>(offsets.size() - 1);
  return {
      matrix_name(file),
      VisibilityMatrix::from_csr({lists, data.matrix.shape().columns}, std::move(offsets), std::move(ids)),
      2};
}

Permutation order_of(const VisibilityMatrix& matrix, const std::string& order) {
  const std::uint32_t columns = matrix.shape().columns;
  if (order == "random") return random_order(columns, 1);
  if (order == "best") return best_order(matrix);
  // The paper's 700 of 11,200 samples for 400,000 columns, and as few of fewer.
  const auto neighbours = static_cast<std::uint32_t>(std::max(8., std::round(700. * columns / 400000)));
  return order_by_sampled_tour(matrix, {.neighbours = neighbours, .samples = 16 * neighbours});
}

// Bytes of the pairs of all lists, each number in 32 bits, through LZW [Welch 1984]: fresh for each list, codes of 9 to 16 bits.
std::uint64_t lzw_bytes_of_words(const VisibilityMatrix& matrix) {
  std::uint64_t bytes = 0;
  std::vector<std::uint32_t> memory;
  std::unordered_map<std::uint32_t, std::uint32_t> longer;  // entry << 8 | byte -> entry
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto numbers = pairs_of_row(matrix.row(r), memory);
    longer.clear();
    std::uint64_t bits = 0;
    std::optional<std::uint32_t> entry;
    std::uint32_t entries = 256;
    for (const std::byte b : std::as_bytes(numbers)) {
      const auto byte = std::to_integer<std::uint32_t>(b);
      if (!entry) {
        entry = byte;
      } else if (const auto found = longer.find(*entry << 8 | byte); found != longer.end()) {
        entry = found->second;
      } else {
        bits += static_cast<std::uint64_t>(std::bit_width(entries - 1));
        if (entries < 65536) longer[*entry << 8 | byte] = entries++;
        entry = byte;
      }
    }
    if (entry) bits += static_cast<std::uint64_t>(std::bit_width(entries - 1));
    bytes += (bits + 7) / 8;
  }
  return bytes;
}

void print(const std::string& code, double bitmask, double pairs, double bytes, double differences,
           const Times* encode, const Times* decode) {
  std::printf("  %-20s %14.0f %9.2fx", code.c_str(), bytes, bitmask / bytes);
  if (encode == nullptr) {
    std::printf("\n");
  } else {
    std::printf(" %9.2fx %9.1f %9.2f %9.2f  (%.2f to %.2f)\n", pairs / bytes, bytes / differences,
                1e6 * encode->median / differences, 1e6 * decode->median / differences,
                1e6 * decode->least / differences, 1e6 * decode->most / differences);
  }
  std::fflush(stdout);
}

void measure(const DeltaMatrix& subject, const VlodTablesOptions& options, std::string& csv) {
  for (const std::string& order : options.orders) {
    const VisibilityMatrix matrix = permute(subject.lists, Permutation::identity(subject.lists.shape().rows),
                                            order_of(subject.lists, order));
    const Shape shape = matrix.shape();
    const double differences = static_cast<double>(shape.rows) / subject.lists_of_difference;
    const std::uint64_t runs = count_runs(matrix), bitmask = bitmap_size(shape), ids = 4 * matrix.ones(),
                        pairs = 8 * runs;
    std::printf(
        "\n%s: %.0f differences in %u lists over %u columns, density %.3f %%; order %s: %.2f ones a run\n",
        subject.name.c_str(), differences, shape.rows, shape.columns, 100 * matrix.density(), order.c_str(),
        static_cast<double>(matrix.ones()) / static_cast<double>(std::max<std::uint64_t>(1, runs)));
    std::printf("  %-20s %14s %10s %10s %9s %9s %9s  %s\n", "", "bytes", "bit masks", "pairs", "B a diff",
                "encode us", "decode us", "(least to most)");
    const auto keep = [&](const std::string& code, std::uint64_t bytes, const Times* encode,
                          const Times* decode) {
      print(code, static_cast<double>(bitmask), static_cast<double>(pairs), static_cast<double>(bytes),
            differences, encode, decode);
      const auto us = [&](const Times* t, double Times::*which) {
        return t == nullptr ? 0 : 1e6 * t->*which / differences;
      };
      csv += csv_line(subject.name, shape.rows, shape.columns, matrix.ones(), differences, order, runs,
                      bitmask, code, bytes, us(encode, &Times::median), us(decode, &Times::median),
                      us(decode, &Times::least), us(decode, &Times::most));
    };
    keep("bit masks", bitmask, nullptr, nullptr);
    keep("ids of 32 bits", ids, nullptr, nullptr);
    keep("pairs of 32 bits", pairs, nullptr, nullptr);
    keep("lzw of 32 bits", lzw_bytes_of_words(matrix), nullptr, nullptr);
    for (const std::string& name : options.codes) {
      const Codec& codec = find_codec(name);
      const Container container = compress(matrix, codec);
      if (decompress(container, codec) != matrix)
        throw std::runtime_error(name + " does not restore the matrix");
      const auto file = write_container(container);
      const RowReader reader(file, std::span(&codec, 1));
      RowBuffer<std::uint32_t> buffer;
      const Times encode = time_passes({options.seconds}, [&] { codec.encode(matrix, {}, {}); });
      const Times decode = time_passes({options.seconds}, [&] {
        for (std::uint32_t r = 0; r < shape.rows; ++r) reader.ids(r, buffer);
      });
      keep(name, container.encoded.payload.size(), &encode, &decode);
    }
  }
}

void run_vlod_tables(const VlodTablesOptions& options) {
  std::string csv =
      "matrix,rows,columns,ones,differences,order,runs,bitmask_bytes,code,bytes,encode_us,decode_us,decode_"
      "us_least,decode_us_most\n";
  for (const double scale : options.scales) {
    char name[64];
    std::snprintf(name, sizeof name, "power-plant 1/%.0f", 1 / scale);
    measure({name, generate_delta_scene(power_plant_scene(scale))}, options, csv);
  }
  for (const auto& file : options.files) measure(read(file), options, csv);
  write_table(options.csv, csv);
}

}  // namespace

void add_vlod_tables(const Verb& verb) {
  const auto o = std::make_shared<VlodTablesOptions>();
  verb.input("MATRIX", o->files, "Matrices of differences, as vismat deltas writes them");
  verb.option("--scale", o->scales, "Also the synthetic power plant, at these shares of the paper's size")
      .comma_separated()
      .between(1e-4, 1.);
  verb.option("--orders", o->orders,
              "Orders of the columns; printed: the published method (sampled-tour), section 6.1; best: ours")
      .one_of({"random", "printed", "best"})
      .comma_separated();
  verb.option("--codes", o->codes, "Codecs that read single rows, named as in 'vismat encode'")
      .comma_separated();
  verb.option("--seconds", o->seconds, "Seconds spent on each time that is measured").between(0, 1e7);
  verb.output("--csv", o->csv, Written::text, "File for the tables as CSV");
  verb.example("bench vlod-tables differences.bsp.h5 --orders best --csv codes.csv");
  verb.runs([o] { run_vlod_tables(*o); });
}

}  // namespace vismat::bench
