// Verbs that Google Benchmark times: the rest of their command line is its own, but for what it leaves.
#pragma once
#include <string>
#include <vector>

namespace vismat::bench {

/// Takes the options --benchmark_...=... and gives what is left. Throws std::invalid_argument, with `usage`, where more than
/// `most` arguments are left or one that begins with '-'.
std::vector<std::string> start_google_benchmark(std::vector<std::string> arguments, std::size_t most,
                                                const std::string& usage);

}  // namespace vismat::bench
