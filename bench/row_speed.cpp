// Measures what single rows out of a .vmat file cost, with Google Benchmark.
//
// It times every row codec in each output form (ids, runs, bits), read into one buffer: warm, one file over and over, in
// shuffled order; sequence, the same from the first row to the last; and cold, from shuffled copies of the file, three times
// the last-level cache (at most 768 MB), so that a row comes from memory, its index too. Before that every row's content is
// checked (its sum against the row's). The times are the median and the spread of 7 repetitions. Bytes per second are those
// of the bitmap, items are ids; of_quake_rle and of_roaring are the codec's bytes to those of these codecs in the same order;
// p50_ns and p99_ns are single rows' times on the wall, less that of reading the clock. memcpy/... copies the same rows,
// uncompressed: other processes slow it down as they do the codecs. open/...: a file of 100 MB in the page cache is mapped,
// and asked for a row's place in its index.
//
// NAME/shares: what a row takes of a file that was just opened, none of whose blocks is checked. The microseconds of the rows
// around the median and of the slowest 2 per cent, and their shares: fetching, which is the walk through the index to the row's parts;
// the checksums of the blocks that these and the index lie in, which later rows need no more; and decoding, the rest. Of each row
// the least of several times counts. Columns stay in their order; rows move where the codec likes that.
//
// Without a matrix: 4096 differences over 100,000 columns, about as Chhugani et al. 2005 have them (0.5 % dense, 3 ones in a run,
// 750 bytes).
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/google_benchmark.h"
#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/rows/row_codec.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "layout/orders/random_order.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/random.h"
#include "matrix/files/dataset_file.h"
#include "programs/measuring.h"

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

// The three forms of a row, each with its buffer and the sum of the row's ids.
struct Ids {
  static constexpr const char* name = "ids";
  RowBuffer<std::uint32_t> buffer;
  explicit Ids(Shape) {}
  std::span<const std::uint32_t> read(const RowReader& reader, std::uint32_t row) {
    return reader.ids(row, buffer);
  }
  static std::uint64_t sum(std::span<const std::uint32_t> ids) { return sum_of(ids); }
};
struct Runs {
  static constexpr const char* name = "runs";
  RowBuffer<Run> buffer;
  explicit Runs(Shape) {}
  std::span<const Run> read(const RowReader& reader, std::uint32_t row) { return reader.runs(row, buffer); }
  static std::uint64_t sum(std::span<const Run> runs) {
    std::uint64_t sum = 0;
    for (const Run run : runs)
      sum += std::uint64_t{run.first} * run.count + std::uint64_t{run.count} * (run.count - 1) / 2;
    return sum;
  }
};
struct Bits {
  static constexpr const char* name = "bits";
  std::vector<std::uint64_t> words;
  RowScratch scratch;
  explicit Bits(Shape shape) : words((std::size_t{shape.columns} + 63) / 64) {}
  std::span<const std::uint64_t> read(const RowReader& reader, std::uint32_t row) {
    reader.bits(row, words, scratch);
    return words;
  }
  static std::uint64_t sum(std::span<const std::uint64_t> words) {
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
std::uint64_t expected_sum(std::span<const std::uint32_t> ids) {
  if constexpr (requires { Form::expected(ids); })
    return Form::expected(ids);
  else
    return sum_of(ids);
}

std::size_t cache_bytes() {
  const long bytes = sysconf(_SC_LEVEL3_CACHE_SIZE);
  return std::clamp<std::size_t>(bytes > 0 ? static_cast<std::size_t>(bytes) : 0, 32u << 20, 256u << 20);
}

enum class Order { warm, sequence, cold };
constexpr std::array order_names = {"warm", "sequence", "cold"};

struct Visit {
  std::uint32_t copy, row;
};

std::vector<Visit> visits_in(Order order, std::uint32_t copies, std::uint32_t rows) {
  std::vector<Visit> visits;
  for (std::uint32_t c = 0; c < copies; ++c) {
    for (std::uint32_t r = 0; r < rows; ++r) visits.push_back({c, r});
  }
  if (order == Order::sequence) return visits;
  Random random(2);
  for (std::size_t i = visits.size(); i > 1; --i)
    std::swap(visits[i - 1], visits[random.below(static_cast<std::uint32_t>(i))]);
  return visits;
}

// A codec's file, once or in enough copies to be cold, and the order in which rows are asked for. Made when it is first
// needed, as Google Benchmark calls a benchmark several times.
struct Files {
  std::vector<std::vector<std::byte>> bytes;
  std::vector<RowReader> readers;
  std::vector<Visit> visits;
  double of_quake_rle, of_roaring;  // the codec's bytes to theirs, in the same order

  Files(const Codec& codec, const VisibilityMatrix& matrix, Order order) {
    const Container container = compress(matrix, codec);
    const auto ratio_to = [&](const char* other) {
      return static_cast<double>(container.encoded.bytes()) /
             static_cast<double>(find_codec(other).encode(matrix, {}, {}).bytes());
    };
    of_quake_rle = ratio_to("quake-rle");
    of_roaring = ratio_to("roaring");
    const auto file = write_container(container);
    bytes.assign(order == Order::cold ? std::min<std::size_t>(4096, 1 + 3 * cache_bytes() / file.size()) : 1,
                 file);
    RowBuffer<std::uint32_t> buffer;
    for (const auto& copy : bytes) {
      readers.emplace_back(copy, std::span(&codec, 1));
      for (std::uint32_t r = 0; r < matrix.shape().rows; ++r)
        readers.back().ids(r, buffer);  // checks its blocks
    }
    visits = visits_in(order, static_cast<std::uint32_t>(bytes.size()), matrix.shape().rows);
  }
};

// One set of files at a time is kept: the benchmarks of a codec follow one another.
const Files& files_of(const Codec& codec, const VisibilityMatrix& matrix, Order order) {
  static std::unique_ptr<Files> files;
  static std::string whose;
  const std::string name = std::string(codec.name) + order_names[static_cast<std::size_t>(order)];
  if (whose != name) {
    files.reset();
    files = std::make_unique<Files>(codec, matrix, order);
    whose = name;
  }
  return *files;
}

// Times read(visit), which returns a span.
template <typename Read>
void time_visits(benchmark::State& state, const std::vector<Visit>& visits, const VisibilityMatrix& matrix,
                 const Read& read) {
  std::size_t next = 0;
  const auto read_next = [&] {
    const auto row = read(visits[next]);
    benchmark::DoNotOptimize(row.data());
    benchmark::ClobberMemory();
    next = next + 1 == visits.size() ? 0 : next + 1;
  };
  for (auto _ : state) read_next();
  const double count = static_cast<double>(state.iterations()) / matrix.shape().rows;
  state.SetItemsProcessed(static_cast<std::int64_t>(count * static_cast<double>(matrix.ones())));
  state.SetBytesProcessed(state.iterations() *
                          static_cast<std::int64_t>(row_bytes_of(matrix.shape().columns)));
  std::vector<double> clock(1001), times(20000);
  for (double& t : clock) t = seconds_of([] {});
  for (double& t : times) t = seconds_of(read_next);
  for (const auto& [name, share] : {std::pair("p50_ns", .5), std::pair("p99_ns", .99)})
    state.counters[name] = 1e9 * std::max(0., quantile(times, share) - median(clock));
}

template <typename Form>
void read_rows(benchmark::State& state, const Codec& codec, const VisibilityMatrix& matrix, Order order) {
  const Files& files = files_of(codec, matrix, order);
  Form form(matrix.shape());
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    if (Form::sum(form.read(files.readers[0], r)) != expected_sum<Form>(matrix.row(r)))
      return state.SkipWithError("wrong ids");
  }
  time_visits(state, files.visits, matrix,
              [&](Visit visit) { return form.read(files.readers[visit.copy], visit.row); });
  state.counters["of_quake_rle"] = files.of_quake_rle;
  state.counters["of_roaring"] = files.of_roaring;
}

void copy_ids(benchmark::State& state, const VisibilityMatrix& matrix, Order order) {
  std::vector<std::uint32_t> ids(matrix.shape().columns);
  time_visits(state, visits_in(order, 1, matrix.shape().rows), matrix, [&](Visit visit) {
    const auto row = matrix.row(visit.row);
    if (!row.empty()) std::memcpy(ids.data(), row.data(), row.size_bytes());
    return std::span<const std::uint32_t>(ids);
  });
}

void copy_bits(benchmark::State& state, const VisibilityMatrix& matrix, Order order) {
  const auto [rows, columns] = matrix.shape();
  const std::size_t words = (std::size_t{columns} + 63) / 64;
  std::vector<std::uint64_t> all(rows * words), copy(words);
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (const std::uint32_t id : matrix.row(r)) all[r * words + id / 64] |= std::uint64_t{1} << (id % 64);
  }
  time_visits(state, visits_in(order, 1, rows), matrix, [&](Visit visit) {
    std::memcpy(copy.data(), all.data() + visit.row * words, row_bytes_of(columns));
    return std::span<const std::uint64_t>(copy);
  });
}

struct RowTime {
  double fetch = 1e9, later = 1e9, first = 1e9;  // seconds; later: as first, but the blocks are checked
};

// Of up to 1000 rows in any order, each alone: nothing is left of the rows before it.
std::vector<RowTime> times_of_rows(const Codec& codec, const VisibilityMatrix& matrix) {
  const auto file = write_container(compress(matrix, codec, {}, {.rows_may_move = true}));
  const RowReader reader(file, std::span(&codec, 1)), other(file, std::span(&codec, 1));
  std::vector<std::uint32_t> rows = random_order(matrix.shape().rows, 1).old_of_new();
  rows.resize(std::min<std::size_t>(1000, rows.size()));
  RowBuffer<std::uint32_t> buffer;
  std::vector<RowTime> times(rows.size());
  double clock = 1e9;
  const auto least = [&](double& time, const auto& work) { time = std::min(time, seconds_of(work)); };
  for (int pass = 0; pass < 5; ++pass) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::uint32_t row = rows[i];
      least(clock, [] {});
      least(times[i].fetch, [&] { benchmark::DoNotOptimize(reader.cost(row)); });
      reader.ids(row, buffer);
      other.ids(row, buffer);
      least(times[i].later, [&] { reader.ids(row, buffer); });
      const RowReader fresh(file, std::span(&codec, 1));
      least(times[i].first, [&] { fresh.ids(row, buffer); });
    }
  }
  for (RowTime& time : times) {
    time.later = std::max(0., time.later - clock);
    time.fetch = std::clamp(time.fetch - clock, 0., time.later);
    time.first = std::max(time.later, time.first - clock);
  }
  std::ranges::sort(times, {}, &RowTime::first);
  return times;
}

void row_shares(benchmark::State& state, const Codec& codec, const VisibilityMatrix& matrix) {
  for (auto _ : state) {
    const auto times = times_of_rows(codec, matrix);
    const auto tell = [&](const std::string& name, double from, double to) {
      const auto count = static_cast<double>(times.size());
      RowTime sum{0, 0, 0};
      const auto end = static_cast<std::size_t>(std::ceil(to * count));
      const auto begin = std::min(static_cast<std::size_t>(from * count), end - 1);
      for (std::size_t i = begin; i < end; ++i) {
        sum.fetch += times[i].fetch;
        sum.later += times[i].later;
        sum.first += times[i].first;
      }
      state.counters[name + "_us"] = 1e6 * sum.first / static_cast<double>(end - begin);
      state.counters[name + "_fetch"] = sum.fetch / sum.first;
      state.counters[name + "_checksum"] = (sum.first - sum.later) / sum.first;
      state.counters[name + "_decode"] = (sum.later - sum.fetch) / sum.first;
    };
    tell("p50", .45, .55);
    tell("p99", .98, 1);
  }
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

template <typename Run>
void register_rows(std::string_view what, const char* form, Order order, const Run& run) {
  const std::string name =
      std::string(what) + "/" + form + "/" + order_names[static_cast<std::size_t>(order)];
  benchmark::RegisterBenchmark(name.c_str(), run);
}

template <typename Form>
void register_form(const Codec& codec, const VisibilityMatrix& matrix, Order order) {
  register_rows(codec.name, Form::name, order, [&codec, &matrix, order](benchmark::State& state) {
    read_rows<Form>(state, codec, matrix, order);
  });
}

void run_row_speed(const VisibilityMatrix& matrix) {
  std::vector<Codec> codecs = all_codecs();
  std::erase_if(codecs, [](const Codec& codec) { return !codec.rows_alone(); });
  for (const Order order : {Order::warm, Order::sequence}) {
    register_rows("memcpy", Ids::name, order,
                  [&matrix, order](benchmark::State& state) { copy_ids(state, matrix, order); });
    register_rows("memcpy", Bits::name, order,
                  [&matrix, order](benchmark::State& state) { copy_bits(state, matrix, order); });
  }
  for (const Codec& codec : codecs) {
    for (const Order order : {Order::warm, Order::sequence, Order::cold}) {
      register_form<Ids>(codec, matrix, order);
      register_form<Runs>(codec, matrix, order);
      register_form<Bits>(codec, matrix, order);
    }
    if (matrix.shape().rows == 0) continue;
    const std::string name = std::string(codec.name) + "/shares";
    benchmark::RegisterBenchmark(name.c_str(), [&codec, &matrix](benchmark::State& state) {
      row_shares(state, codec, matrix);
    })->Iterations(1);
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
