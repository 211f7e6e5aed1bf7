// Measures what single rows out of a .vmat file cost, with Google Benchmark.
//
// It times every row codec in each output form (ids, runs, bits), with warm and with cold caches. Rows come in shuffled order into one buffer, and every
// row's content is checked within the timed loop (its sum against the row's). Warm: one file, read over and over. Cold:
// copies of it, three times the last-level cache (at most 768 MB), so that a row comes from memory, its index too. The times are
// the median and the spread of 7 repetitions. Bytes per second are those of the bitmap, items are ids; of_quake_rle and
// of_roaring are the codec's bytes to those of these codecs in the same order. open/...: a file of 100 MB in the page cache is
// mapped, and asked for a row's place in its index.
//
// Without a matrix: 4096 differences over 100,000 columns, about as Chhugani et al. 2005 have them (0.5 % dense, 3 ones in a run,
// 750 bytes).
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/google_benchmark.h"
#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/rows/row_codec.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/random.h"
#include "matrix/files/dataset_file.h"

namespace vismat::bench {
namespace {

VisibilityMatrix differences_like_the_papers() {
  Random random(1);
  std::vector<std::vector<std::uint32_t>> rows(4096);
  for (auto& row : rows) {
    // Gaps and lengths are geometric with a tail, as after a good order: most gaps within a region are short.
    for (std::uint64_t c = random.below(2000); c < 100000;) {
      std::uint32_t count = 1;
      while (random.below(3) != 0) ++count;
      for (std::uint32_t i = 0; i < count && c < 100000; ++i) row.push_back(static_cast<std::uint32_t>(c++));
      c += random.below(8) == 0 ? 1 + random.below(8000) : 1 + random.below(60);
    }
  }
  return VisibilityMatrix::from_rows(rows, 100000);
}

std::uint64_t sum_of(std::span<const std::uint32_t> ids) {
  return std::accumulate(ids.begin(), ids.end(), std::uint64_t{0});
}

// The three forms of a row, each with its buffer, as the sum of the row's ids.
struct Ids {
  static constexpr const char* name = "ids";
  RowBuffer<std::uint32_t> buffer;
  std::uint64_t read(const RowReader& reader, std::uint32_t row) { return sum_of(reader.ids(row, buffer)); }
};
struct Runs {
  static constexpr const char* name = "runs";
  RowBuffer<Run> buffer;
  std::uint64_t read(const RowReader& reader, std::uint32_t row) {
    std::uint64_t sum = 0;
    for (const Run run : reader.runs(row, buffer))
      sum += std::uint64_t{run.first} * run.count + std::uint64_t{run.count} * (run.count - 1) / 2;
    return sum;
  }
};
struct Bits {
  static constexpr const char* name = "bits";
  std::vector<std::uint64_t> words;
  RowScratch scratch;
  std::uint64_t read(const RowReader& reader, std::uint32_t row) {
    words.resize((reader.shape().columns + 63) / 64);
    reader.bits(row, words, scratch);
    std::uint64_t sum = 0;  // of the ids in each word, but for what all bits of a word share
    for (std::size_t w = 0; w < words.size(); ++w)
      sum += std::uint64_t{w} * static_cast<std::uint64_t>(std::popcount(words[w]));
    return sum;
  }
  static std::uint64_t expected(std::span<const std::uint32_t> ids) {
    std::uint64_t sum = 0;
    for (const std::uint32_t id : ids) sum += id / 64;
    return sum;
  }
};

template <typename Form>
std::vector<std::uint64_t> expected_sums(const VisibilityMatrix& matrix) {
  std::vector<std::uint64_t> sums;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    if constexpr (requires { Form::expected(matrix.row(r)); })
      sums.push_back(Form::expected(matrix.row(r)));
    else
      sums.push_back(sum_of(matrix.row(r)));
  }
  return sums;
}

std::size_t cache_bytes() {
  const long bytes = sysconf(_SC_LEVEL3_CACHE_SIZE);
  return std::clamp<std::size_t>(bytes > 0 ? static_cast<std::size_t>(bytes) : 0, 32u << 20, 256u << 20);
}

// A codec's file, once or in enough copies to be cold, and the order in which rows are asked for. Made when it is first
// needed, as Google Benchmark calls a benchmark several times.
struct Files {
  struct Visit {
    std::uint32_t copy, row;
  };
  std::vector<std::vector<std::byte>> bytes;
  std::vector<RowReader> readers;
  std::vector<Visit> visits;
  double of_quake_rle, of_roaring;  // the codec's bytes to theirs, in the same order

  Files(const Codec& codec, const VisibilityMatrix& matrix, bool cold) {
    const Container container = compress(matrix, codec);
    const auto ratio_to = [&](const char* other) {
      return static_cast<double>(container.encoded.bytes()) /
             static_cast<double>(find_codec(other).encode(matrix, {}, {}).bytes());
    };
    of_quake_rle = ratio_to("quake-rle");
    of_roaring = ratio_to("roaring");
    const auto file = write_container(container);
    bytes.assign(cold ? std::min<std::size_t>(4096, 1 + 3 * cache_bytes() / file.size()) : 1, file);
    RowBuffer<std::uint32_t> buffer;
    for (std::uint32_t c = 0; c < bytes.size(); ++c) {
      readers.emplace_back(bytes[c], std::span(&codec, 1));
      for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
        visits.push_back({c, r});
        readers[c].ids(r, buffer);  // checks its blocks
      }
    }
    Random random(2);
    for (std::size_t i = visits.size(); i > 1; --i)
      std::swap(visits[i - 1], visits[random.below(static_cast<std::uint32_t>(i))]);
  }
};

// One set of files at a time is kept: the benchmarks of a codec follow one another.
const Files& files_of(const Codec& codec, const VisibilityMatrix& matrix, bool cold) {
  static std::unique_ptr<Files> files;
  static std::string whose;
  const std::string name = std::string(codec.name) + (cold ? "/cold" : "/warm");
  if (whose != name) {
    files.reset();
    files = std::make_unique<Files>(codec, matrix, cold);
    whose = name;
  }
  return *files;
}

template <typename Form>
void read_rows(benchmark::State& state, const Codec& codec, const VisibilityMatrix& matrix, bool cold) {
  const Files& files = files_of(codec, matrix, cold);
  const auto sums = expected_sums<Form>(matrix);
  Form form;
  std::uint64_t ids = 0, bytes = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    const Files::Visit visit = files.visits[next];
    next = next + 1 == files.visits.size() ? 0 : next + 1;
    if (form.read(files.readers[visit.copy], visit.row) != sums[visit.row]) {
      state.SkipWithError("wrong ids");
      break;
    }
    ids += matrix.row(visit.row).size();
    bytes += row_bytes_of(matrix.shape().columns);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(ids));
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
  state.counters["of_quake_rle"] = files.of_quake_rle;
  state.counters["of_roaring"] = files.of_roaring;
}

// Rows of random bits, which every codec of ours with an escape stores as bitmaps; one row is empty, so that the file has an
// index.
Container large_container(const Codec& codec) {
  const Shape shape{8001, 100000};
  Container container;
  container.shape = shape;
  container.codec = codec.name;
  std::vector<std::uint64_t> starts;
  auto& payload = container.encoded.payload;
  payload.resize((shape.rows - 1) * row_bytes_of(shape.columns));
  Random random(3);
  for (std::byte& byte : payload) {
    byte = static_cast<std::byte>(random.below(256));
    container.ones += static_cast<std::uint64_t>(std::popcount(std::to_integer<unsigned>(byte)));
  }
  for (std::uint32_t r = 0; r < shape.rows; ++r)
    starts.push_back((r - (r > 4000)) * row_bytes_of(shape.columns));
  container.encoded.index = part_index_bytes(starts, payload.size());
  return container;
}

// Gone at the program's end.
struct LargeFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("vismat-open-" + std::to_string(getpid()) + ".vmat");
  explicit LargeFile(const Codec& codec) { write_file(path, write_container(large_container(codec))); }
  ~LargeFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

void open_file(benchmark::State& state, const Codec& codec) {
  static const LargeFile file(codec);
  for (auto _ : state) {
    const RowReader reader(file.path, std::span(&codec, 1));
    if (reader.cost(4000).bytes != 0) state.SkipWithError("wrong row");
  }
  state.counters["file_bytes"] = static_cast<double>(std::filesystem::file_size(file.path));
}

template <typename Form>
void register_form(const Codec& codec, const VisibilityMatrix& matrix, bool cold) {
  const std::string name = std::string(codec.name) + "/" + Form::name + (cold ? "/cold" : "/warm");
  benchmark::RegisterBenchmark(name.c_str(), [&codec, &matrix, cold](benchmark::State& state) {
    read_rows<Form>(state, codec, matrix, cold);
  });
}

void run_row_speed(const VisibilityMatrix& matrix) {
  std::vector<Codec> codecs = all_codecs();
  std::erase_if(codecs, [](const Codec& codec) { return !codec.rows_alone(); });
  for (const Codec& codec : codecs) {
    for (const bool cold : {false, true}) {
      register_form<Ids>(codec, matrix, cold);
      register_form<Runs>(codec, matrix, cold);
      register_form<Bits>(codec, matrix, cold);
    }
  }
  benchmark::RegisterBenchmark("open/delimiter",
                               [](benchmark::State& state) { open_file(state, find_codec("delimiter")); });
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

void add_row_speed(const Verb& verb) {
  const auto file = std::make_shared<std::filesystem::path>();
  verb.input("MATRIX", *file,
             "Matrix file; without one, differences like those of Chhugani et al. 2005 are made");
  verb.note(
      "Other arguments are Google Benchmark's: --benchmark_filter=REGEX, --benchmark_repetitions=9, ...");
  verb.example("bench row-speed koth1.bsp.h5 --benchmark_filter=delimiter");
  verb.runs_with_rest([file](std::vector<std::string> arguments) {
    const std::string first[] = {"--benchmark_repetitions=7", "--benchmark_report_aggregates_only=true"};
    arguments.insert(arguments.begin(), std::begin(first), std::end(first));
    start_google_benchmark(std::move(arguments), "bench row-speed [MATRIX]");
    run_row_speed(file->empty() ? differences_like_the_papers() : read_dataset(*file).matrix);
  });
}

}  // namespace vismat::bench
