// What work costs: seconds, medians of repeated passes, the peak of memory, and work in a process of its own.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>
#include <vector>

namespace vismat {

/// By a clock that is never set back.
double wall_seconds();

/// Of all threads of this process: what work would take on a machine to itself lies between this and this over
/// its threads.
double processor_seconds();

double seconds_of(const auto& work) {
  const double start = wall_seconds();
  work();
  return wall_seconds() - start;
}

/// Of an even number of values the larger of the two in the middle; 0 of none.
double median(std::vector<double> values);

/// The value that lies `share` of the way from the least (0) to the most (1) in ascending order, of two the lower one; 0 of none.
double quantile(std::vector<double> values, double share);

/// How often work is done to time it: `least` passes, then more as long as they begin within `seconds` of the first, up
/// to `most`. None follows one that took five times `seconds`.
struct Passes {
  double seconds = 0;
  std::size_t least = 3, most = ~std::size_t{0};
};

/// Seconds of a pass.
struct Times {
  double median = 0, least = 0, most = 0;
  std::size_t passes = 0;
};
Times time_passes(const Passes& passes, const std::function<void()>& work);

/// The most memory that this process has held at a time.
std::uint64_t peak_bytes();

/// The bytes that `work` returns, done in a child process.
std::vector<std::byte> bytes_apart(const std::function<std::vector<std::byte>()>& work);

/// What `work` returns, done in a child process, so that its peak_bytes() are of this work and of what was there before it.
/// Its exceptions are told on stderr and become a std::runtime_error here. Call it from a process with one thread.
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
