// Codecs and orders on one matrix, for Google Benchmark:
//
//   speed MATRIX.bsp.h5 [--benchmark_filter=... --benchmark_repetitions=9 ...]
//
// Bytes per second are those of the bitmap, so codecs compare with one another and with a copy of memory.
// Each codec is checked by a round trip before it is timed.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <exception>
#include <string>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "layout/orders/greedy_order.h"
#include "matrix/files/dataset_file.h"
#include "programs/prepared_for.h"

namespace {

using namespace vismat;

void count_bitmap_bytes(benchmark::State& state, Shape shape) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bitmap_size(shape)));
}

void register_codec(const Codec& codec, const Dataset& data) {
  const std::string name(codec.name);
  benchmark::RegisterBenchmark((name + "/encode").c_str(), [&codec, &data](benchmark::State& state) {
    const Dataset prepared = prepared_for(codec, data, {.orders = false});
    const Side side = side_of(codec, prepared);
    for (auto _ : state) benchmark::DoNotOptimize(codec.encode(prepared.matrix, side, {}).payload.data());
    count_bitmap_bytes(state, prepared.matrix.shape());
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark((name + "/decode").c_str(), [&codec, &data](benchmark::State& state) {
    const Dataset prepared = prepared_for(codec, data, {.orders = false});
    const Side side = side_of(codec, prepared);
    const Encoded encoded = codec.encode(prepared.matrix, side, {});
    const auto decoded = [&] { return decode(codec, encoded, prepared.matrix.shape(), side); };
    if (decoded() != prepared.matrix) state.SkipWithError("does not restore the matrix");
    for (auto _ : state) benchmark::DoNotOptimize(decoded().ones());
    count_bitmap_bytes(state, prepared.matrix.shape());
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2) {
    std::fprintf(stderr, "usage: speed MATRIX.bsp.h5 [--benchmark_...]\n");
    return 1;
  }
  try {
    Dataset data = read_dataset(argv[1]);
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
  } catch (const std::exception& error) {
    std::fprintf(stderr, "speed: %s\n", error.what());
    return 1;
  }
  return 0;
}
