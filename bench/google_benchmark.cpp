#include "bench/google_benchmark.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <stdexcept>

namespace vismat::bench {

std::vector<std::string> start_google_benchmark(std::vector<std::string> arguments, std::size_t most,
                                                const std::string& usage) {
  std::string program = "bench";
  std::vector<char*> argv = {program.data()};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  std::vector<std::string> left(argv.begin() + 1, argv.begin() + argc);
  if (left.size() > most ||
      std::ranges::any_of(left, [](const std::string& s) { return s.starts_with('-'); }))
    throw std::invalid_argument("usage: " + usage + " [--benchmark_filter=REGEX ...]");
  return left;
}

}  // namespace vismat::bench
