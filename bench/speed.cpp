// Measures the speed of codecs and orders on one matrix, with Google Benchmark.
//
// Bytes per second are those of the bitmap, so codecs compare with one another and with a copy of memory.
// Each codec is checked by a round trip before it is timed.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/google_benchmark.h"
#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "layout/orders/greedy_order.h"
#include "matrix/files/dataset_file.h"
#include "programs/prepared_for.h"

namespace vismat::bench {
namespace {

void count_bitmap_bytes(benchmark::State& state, Shape shape) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bitmap_size(shape)));
}

void register_codec(const Codec& codec, const Dataset& data) {
  const std::string name(codec.name);
  benchmark::RegisterBenchmark((name + "/encode").c_str(), [&codec, &data](benchmark::State& state) {
    const Dataset prepared = prepared_for(codec, data, {.orders = false});
    const auto side = side_of(codec, prepared);
    for (auto _ : state) benchmark::DoNotOptimize(codec.encode(prepared.matrix, side, {}).payload.data());
    count_bitmap_bytes(state, prepared.matrix.shape());
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark((name + "/decode").c_str(), [&codec, &data](benchmark::State& state) {
    const Dataset prepared = prepared_for(codec, data, {.orders = false});
    const auto side = side_of(codec, prepared);
    const Encoded encoded = codec.encode(prepared.matrix, side, {});
    const auto decoded = [&] { return decode(codec, encoded, prepared.matrix.shape(), side); };
    if (decoded() != prepared.matrix) state.SkipWithError("does not restore the matrix");
    for (auto _ : state) benchmark::DoNotOptimize(decoded().ones());
    count_bitmap_bytes(state, prepared.matrix.shape());
  })->Unit(benchmark::kMillisecond);
}

void run_speed(Dataset data) {
  if (data.source.tree && !data.source.columns_are_nodes) data = over_nodes(data);
  const std::vector<Codec> codecs = all_codecs();
  for (const Codec& codec : codecs) {
    if (obstacle(codec, data).empty()) register_codec(codec, data);
  }
  benchmark::RegisterBenchmark("order/greedy", [&data](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(order_rows_greedily(data.matrix).size());
  })->Unit(benchmark::kMillisecond);
  if (data.row_neighbours) {
    benchmark::RegisterBenchmark("order/neighbours", [&data](benchmark::State& state) {
      for (auto _ : state)
        benchmark::DoNotOptimize(order_rows_by_neighbours(data.matrix, *data.row_neighbours).size());
    })->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

void add_speed(const Verb& verb) {
  const auto file = std::make_shared<std::filesystem::path>();
  verb.input("MATRIX", *file, "Matrix file").required();
  verb.note(
      "Other arguments are Google Benchmark's: --benchmark_filter=REGEX, --benchmark_repetitions=9, ...");
  verb.example("bench speed koth1.bsp.h5 --benchmark_filter=decode");
  verb.runs_with_rest([file](const std::vector<std::string>& arguments) {
    start_google_benchmark(arguments, "bench speed MATRIX");
    run_speed(read_dataset(*file));
  });
}

}  // namespace vismat::bench
