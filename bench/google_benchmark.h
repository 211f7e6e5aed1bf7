// Starts Google Benchmark for the verbs that it times, with the part of their command line that is its own.
#pragma once
#include <string>
#include <vector>

namespace vismat::bench {

/// Takes the options --benchmark_...=.... Throws std::invalid_argument, with `usage`, if there are other arguments.
void start_google_benchmark(std::vector<std::string> arguments, const std::string& usage);

}  // namespace vismat::bench
