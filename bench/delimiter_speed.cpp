// Measures how fast the delimiter code's decoder and encoder are on lists of about 750 bytes, the size of a difference in Chhugani
// et al. 2005, Table 2.
//
// Times are those of one list; items are numbers. Every list that is decoded is checked, by the sum of its numbers, in the
// time that is shown.
//   warm   32 lists, which fit the L1 cache, over and over: the branch predictor learns them
//   many   1024 lists, which fit the L2 cache: it does not
//   cold   copies of 2048 lists, 96 MB of them, in random order; read/cold only sums their bytes in the same order,
//          which is the cost of memory alone
// by-table is the decoder for machines without fast bit extraction, plain the pass bit by bit.
// ratio: decoder and plain pass in turn on the 1024; `times` is how many times faster the former is.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/google_benchmark.h"
#include "bench/verbs.h"
#include "codecs/integer_codes/delimiter.h"
#include "codecs/integer_codes/delimiter_reference.h"
#include "matrix/base/random.h"
#include "programs/measuring.h"

namespace vismat::bench {
namespace {

using Draw = std::function<std::uint32_t(Random&, std::size_t)>;  // the number at this place of a list

struct List {
  std::vector<std::uint32_t> numbers;
  std::vector<std::byte> bytes;
  std::uint32_t sum;  // modulo 2^32
};

struct Mix {
  std::string name;
  std::vector<List> lists;
};
constexpr std::size_t warm_lists = 32, many_lists = 1024, all_lists = 2048;

std::uint32_t geometric(Random& random, double mean) {
  std::uint32_t number = 1;
  while (random.fraction() * mean > 1) ++number;
  return number;
}

// An offset is small but now and then: one in 33 is anywhere up to 4096.
std::uint32_t offset(Random& random) {
  return random.below(33) == 0 ? 1 + random.below(4096) : geometric(random, 8);
}

std::vector<List> lists_of(const Draw& draw) {
  constexpr std::size_t size = 750;
  std::vector<List> lists(all_lists);
  Random random(1);
  for (List& list : lists) {
    while (list.bytes.size() < size) {
      const std::size_t surely_fit = (size - list.bytes.size()) * 8 / (longest_delimited(32) + 2);
      for (std::size_t i = 0; i <= surely_fit; ++i) list.numbers.push_back(draw(random, list.numbers.size()));
      list.bytes.clear();
      put_delimited(list.bytes, list.numbers);
    }
    list.sum = std::accumulate(list.numbers.begin(), list.numbers.end(), 0u);
  }
  return lists;
}

std::vector<Mix> all_mixes() {
  std::vector<Mix> mixes;
  const auto add = [&mixes](const char* name, const Draw& draw) { mixes.push_back({name, lists_of(draw)}); };
  add("offsets-and-runs", [](Random& r, std::size_t i) { return i % 2 == 0 ? offset(r) : geometric(r, 3); });
  add("offsets", [](Random& r, std::size_t) { return offset(r); });
  add("runs", [](Random& r, std::size_t) { return geometric(r, 3); });
  // What the decoder likes least: ends that windows do not show, and codes that no table holds.
  add("ones", [](Random&, std::size_t) { return 1u; });
  add("ones-and-fives", [](Random& r, std::size_t) { return r.below(30) == 0 ? 5u : 1u; });
  add("large", [](Random& r, std::size_t) { return static_cast<std::uint32_t>(r.next() >> 32 | 1u << 31); });
  return mixes;
}

std::uint32_t sum_of(std::span<const std::byte> bytes,
                     bool by_extraction = DelimitedReader::has_fast_extraction()) {
  std::array<std::uint32_t, 512> numbers;
  DelimitedReader reader(bytes, by_extraction);
  std::uint32_t sum = 0;
  while (const std::size_t count = reader.read(numbers))
    sum = std::accumulate(numbers.begin(), numbers.begin() + count, sum);
  return sum;
}

std::uint32_t sum_of_plain(std::span<const std::byte> bytes, std::vector<std::uint64_t>& numbers) {
  reference::read_delimited_by_bits(bytes, numbers);
  return static_cast<std::uint32_t>(std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0}));
}

// Decodes one list after the other, again from the first after the last.
template <typename Sum>
void decode_in_turn(benchmark::State& state, std::span<const List> lists, const Sum& sum) {
  std::size_t i = 0, numbers = 0;
  for (auto _ : state) {
    const List& list = lists[i];
    if (sum(list.bytes) != list.sum) state.SkipWithError("wrong numbers");
    numbers += list.numbers.size();
    i = i + 1 == lists.size() ? 0 : i + 1;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(numbers));
}

void decode_cold(benchmark::State& state, std::span<const List> lists, bool only_bytes) {
  constexpr std::size_t total = std::size_t{96} << 20;
  struct Copy {
    std::size_t begin, list;
  };
  std::vector<std::byte> bytes;
  std::vector<Copy> copies;
  bytes.reserve(total + 1024);
  while (bytes.size() < total) {
    const std::size_t list = copies.size() % lists.size();
    copies.push_back({bytes.size(), list});
    bytes.insert(bytes.end(), lists[list].bytes.begin(), lists[list].bytes.end());
  }
  Random random(2);
  for (std::size_t i = copies.size() - 1; i > 0; --i)
    std::swap(copies[i], copies[random.below(static_cast<std::uint32_t>(i + 1))]);
  std::size_t i = 0, numbers = 0;
  for (auto _ : state) {
    const List& list = lists[copies[i].list];
    const auto code = std::span(bytes).subspan(copies[i].begin, list.bytes.size());
    if (only_bytes)
      benchmark::DoNotOptimize(std::accumulate(
          code.begin(), code.end(), 0u,
          [](unsigned sum, std::byte byte) { return sum + std::to_integer<unsigned>(byte); }));
    else if (sum_of(code) != list.sum)
      state.SkipWithError("wrong numbers");
    numbers += list.numbers.size();
    i = i + 1 == copies.size() ? 0 : i + 1;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(numbers));
}

void encode(benchmark::State& state, std::span<const List> lists) {
  std::vector<std::byte> bytes;
  std::size_t i = 0, numbers = 0;
  for (auto _ : state) {
    bytes.clear();
    put_delimited(bytes, lists[i].numbers);
    if (bytes != lists[i].bytes) state.SkipWithError("other bytes");
    numbers += lists[i].numbers.size();
    i = i + 1 == lists.size() ? 0 : i + 1;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(numbers));
}

void ratio(benchmark::State& state, std::span<const List> lists) {
  std::vector<std::uint64_t> numbers;
  double fast = 0, plain = 0;  // of processor time: other programs may run
  for (auto _ : state) {
    const double begin = processor_seconds();
    bool right = true;
    for (const List& list : lists) right &= sum_of(list.bytes) == list.sum;
    const double middle = processor_seconds();
    for (const List& list : lists) right &= sum_of_plain(list.bytes, numbers) == list.sum;
    const double end = processor_seconds();
    if (!right) state.SkipWithError("wrong numbers");
    fast += middle - begin;
    plain += end - middle;
  }
  state.counters["times"] = plain / fast;
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}
double most(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

void measure(const std::string& name, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), body)
      ->Repetitions(9)
      ->MinTime(0.1)
      ->ComputeStatistics("least", least)
      ->ComputeStatistics("most", most)
      ->ReportAggregatesOnly();
}

void run_delimiter_speed() {
  benchmark::AddCustomContext("compiler", __VERSION__);
  const std::vector<Mix> mixes = all_mixes();
  for (const Mix& mix : mixes) {
    const auto on = [&mix](std::size_t count, const auto& body) {
      return [&mix, count, body](benchmark::State& state) { body(state, std::span(mix.lists).first(count)); };
    };
    const auto decode = [](benchmark::State& state, std::span<const List> lists) {
      decode_in_turn(state, lists, [](std::span<const std::byte> bytes) { return sum_of(bytes); });
    };
    const auto cold = [](benchmark::State& state, std::span<const List> lists) {
      decode_cold(state, lists, false);
    };
    const auto by_table = [](benchmark::State& state, std::span<const List> lists) {
      decode_in_turn(state, lists, [](std::span<const std::byte> bytes) { return sum_of(bytes, false); });
    };
    const auto plain = [](benchmark::State& state, std::span<const List> lists) {
      std::vector<std::uint64_t> numbers;
      decode_in_turn(state, lists,
                     [&numbers](std::span<const std::byte> bytes) { return sum_of_plain(bytes, numbers); });
    };
    measure("decode/" + mix.name + "/warm", on(warm_lists, decode));
    measure("decode/" + mix.name + "/many", on(many_lists, decode));
    measure("decode/" + mix.name + "/cold", on(all_lists, cold));
    measure("by-table/" + mix.name + "/many", on(many_lists, by_table));
    measure("plain/" + mix.name + "/many", on(many_lists, plain));
    measure("ratio/" + mix.name, on(many_lists, ratio));
    measure("encode/" + mix.name + "/many", on(many_lists, encode));
  }
  measure("read/cold", [&mixes](benchmark::State& state) { decode_cold(state, mixes.front().lists, true); });
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

void add_delimiter_speed(const Verb& verb) {
  verb.note(
      "Other arguments are Google Benchmark's: --benchmark_filter=REGEX, --benchmark_repetitions=9, ...");
  verb.example("bench delimiter-speed --benchmark_repetitions=9");
  verb.runs_with_rest([](const std::vector<std::string>& arguments) {
    start_google_benchmark(arguments, "bench delimiter-speed");
    run_delimiter_speed();
  });
}

}  // namespace vismat::bench
