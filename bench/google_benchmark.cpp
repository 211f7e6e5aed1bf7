#include "bench/google_benchmark.h"

#include <benchmark/benchmark.h>

#include <stdexcept>

namespace vismat::bench {

void start_google_benchmark(std::vector<std::string> arguments, const std::string& usage) {
  std::string program = "bench";
  std::vector<char*> argv = {program.data()};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  if (argc > 1) throw std::invalid_argument("usage: " + usage + " [--benchmark_filter=REGEX ...]");
}

}  // namespace vismat::bench
