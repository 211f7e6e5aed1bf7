// Measures what work costs: seconds, medians of repeated passes, and the peak of memory; and runs work in a process of
// its own.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>
#include <vector>

namespace vismat {

/// Seconds by a monotonic clock.
double wall_seconds();

/// Processor seconds of all threads of this process. On an idle machine the work would take at most this long, and at
/// least this divided by the number of threads.
double processor_seconds();

double seconds_of(const auto& work) {
  const double start = wall_seconds();
  work();
  return wall_seconds() - start;
}

/// The median: of an even number of values the larger of the two in the middle, of none 0.
double median(std::vector<double> values);

/// The value that lies `share` of the way from the smallest (0) to the largest (1) in ascending order; between two
/// values the lower one. 0 if there are none.
double quantile(std::vector<double> values, double share);

/// How often work is repeated to time it: `least` passes, then more as long as they begin within `seconds` of the
/// first, up to `most`. No pass follows one that took five times `seconds`.
struct Passes {
  double seconds = 0;
  std::size_t least = 3, most = ~std::size_t{0};
};

/// The seconds that a pass took.
struct Times {
  double median = 0, least = 0, most = 0;
  std::size_t passes = 0;
};
Times time_passes(const Passes& passes, const std::function<void()>& work);

/// The most memory that this process has held at any time.
std::uint64_t peak_bytes();

/// Runs `work` in a child process and returns the bytes that it returned.
std::vector<std::byte> bytes_apart(const std::function<std::vector<std::byte>()>& work);

/// Runs `work` in a child process and returns what it returned, so that peak_bytes() within it counts only this work
/// and what was in memory before it. Its exceptions are printed on stderr and become a std::runtime_error here. Call it
/// from a process with one thread.
template <typename T>
std::vector<T> apart(const std::function<std::vector<T>()>& work) {
  static_assert(std::is_trivially_copyable_v<T>);  // comes through a pipe
  const auto bytes = bytes_apart([&work] {
    const std::vector<T> values = work();
    std::vector<std::byte> copy(values.size() * sizeof(T));
    if (!copy.empty()) std::memcpy(copy.data(), values.data(), copy.size());
    return copy;
  });
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

}  // namespace vismat
