// Measures worst-case rows: the bytes of a row and the time to decode it, for each codec that reads single rows.
//
// Each kind of row stands some hundred times in a matrix of 8192 columns (a bitmap of 1024 bytes for each row). The header of each code proves
// how many bytes a row takes at most; codecs that may store a row as its bitmap never take more than that.
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
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "matrix/base/random.h"
#include "programs/csv.h"
#include "programs/measuring.h"

namespace vismat::bench {
namespace {

constexpr std::uint32_t width = 8192;

struct Kind {
  const char* name;
  const char* why;
  std::function<std::vector<std::uint32_t>(std::uint32_t row)> make;
};

std::vector<std::uint32_t> where(const std::function<bool(std::uint32_t)>& visible) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t c = 0; c < width; ++c) {
    if (visible(c)) ids.push_back(c);
  }
  return ids;
}

// Runs and gaps from this list, over and over.
std::vector<std::uint32_t> lengths(const std::vector<std::uint32_t>& pattern) {
  std::vector<std::uint32_t> ids;
  std::uint32_t c = 0;
  for (std::size_t i = 0; c < width; ++i) {
    const std::uint32_t length = pattern[i % pattern.size()];
    for (std::uint32_t j = 0; j < length && c < width; ++j, ++c) {
      if (i % 2 == 1) ids.push_back(c);
    }
  }
  return ids;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"empty", "what a row costs at least", [](std::uint32_t) { return std::vector<std::uint32_t>{}; }},
      {"full", "one run", [](std::uint32_t) { return where([](std::uint32_t) { return true; }); }},
      {"one id at the end", "one long gap",
       [](std::uint32_t) { return std::vector<std::uint32_t>{width - 1}; }},
      {"alternating",
       "nothing but the number 1: one run of ones in the delimiter code, seen through to its end",
       [](std::uint32_t) { return where([](std::uint32_t c) { return c % 2 == 1; }); }},
      {"lengths 3", "11 in every number: a stuffed bit each", [](std::uint32_t) { return lengths({3}); }},
      {"lengths 1 and 21", "10101: runs of ones end late, then 4 k + 1 of them",
       [](std::uint32_t) {
         return lengths({1, 21});
       }},
      {"lengths 255", "all ones in binary: most stuffed bits", [](std::uint32_t) { return lengths({255}); }},
      {"powers of two", "a new length each time",
       [](std::uint32_t) {
         return lengths({1, 2, 4, 8, 16, 32, 64, 128, 256, 512});
       }},
      {"random half", "no structure, dense",
       [](std::uint32_t row) {
         Random random(row);
         return where([&](std::uint32_t) { return random.below(2) == 1; });
       }},
      {"random 1 %", "no structure, sparse",
       [](std::uint32_t row) {
         Random random(row);
         return where([&](std::uint32_t) { return random.below(100) == 0; });
       }},
  };
  return all;
}

void measure(std::string& csv, double seconds, std::uint32_t copies) {
  std::printf("%-20s %-20s %12s %11s %11s %12s\n", "row", "codec", "bytes a row", "of bitmap", "us a row",
              "M ids/s");
  for (const Kind& kind : kinds()) {
    std::vector<std::vector<std::uint32_t>> lists;
    for (std::uint32_t r = 0; r < copies; ++r) lists.push_back(kind.make(r));
    const auto matrix = VisibilityMatrix::from_rows(lists, width);
    for (const Codec& codec : all_codecs()) {
      if (!codec.rows_alone()) continue;
      const Container container = compress(matrix, codec);
      if (decompress(container, codec) != matrix)
        throw std::runtime_error(std::string(codec.name) + " does not restore " + kind.name);
      const auto file = write_container(container);
      const RowReader reader(file, std::span(&codec, 1));
      RowBuffer<std::uint32_t> buffer;
      const Times pass = time_passes({seconds}, [&] {
        for (std::uint32_t r = 0; r < copies; ++r) reader.ids(r, buffer);
      });
      const double us = 1e6 * pass.median / copies;
      const double bytes = static_cast<double>(container.encoded.payload.size()) / copies;
      const double share = bytes / static_cast<double>(row_bytes_of(width)),
                   rate = static_cast<double>(matrix.ones()) / copies / us;
      std::printf("%-20s %-20s %12.1f %11.3f %11.3f %12.1f\n", kind.name, std::string(codec.name).c_str(),
                  bytes, share, us, rate);
      csv += csv_line(csv_quoted(kind.name), csv_quoted(kind.why), matrix.ones() / copies, codec.name, bytes,
                      share, us);
    }
  }
}

}  // namespace

void add_row_failures(const Verb& verb) {
  struct Options {
    std::filesystem::path csv;
    double seconds = .02;
    std::uint32_t copies = 256;
  };
  const auto o = std::make_shared<Options>();
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.option("--seconds", o->seconds, "Seconds spent on each time that is measured").between(0, 1e7);
  verb.option("--copies", o->copies, "Rows of each kind in its matrix").between(1, 65536);
  verb.example("bench row-failures --csv failures.csv");
  verb.runs([o] {
    std::string csv = "row,why,ones,codec,bytes,of_bitmap,decode_us\n";
    measure(csv, o->seconds, o->copies);
    write_table(o->csv, csv);
  });
}

}  // namespace vismat::bench
