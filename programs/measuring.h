// What the benchmark programs share: time, memory, measurements in a process of their own, lines of CSV.
#pragma once
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/visibility_matrix.h"

namespace vismat::bench {

inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Of all threads of this process: what work would take on a machine to itself lies between this and this over
/// its threads.
inline double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Times {
  double median = 0, least = 0, most = 0;  // seconds of a pass
};

/// Three passes of `work` at least, and more for `seconds`; but none after one that took five times that.
template <typename Work>
Times time_passes(double seconds, const Work& work) {
  std::vector<double> times;
  for (const double begin = wall_seconds(); times.size() < 3 || wall_seconds() - begin < seconds;) {
    const double start = wall_seconds();
    work();
    times.push_back(wall_seconds() - start);
    if (times.back() > 5 * seconds) break;
  }
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times.front(), times.back()};
}

/// The most memory that this process has held at a time.
inline std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// What `work` returns, done in a child process, so that its peak_bytes() are of this work and of what was
/// there before it. Its exceptions are told on stderr and become a std::runtime_error here. Call it from a
/// process with one thread.
template <typename T>
std::vector<T> apart(const std::function<std::vector<T>()>& work) {
  static_assert(std::is_trivially_copyable_v<T>);  // comes through a pipe
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe to be had");
  std::cout.flush();
  std::fflush(stdout);
  malloc_trim(0);  // the child begins with what is in use alone
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process to be had");
  if (child == 0) {
    close(ends[0]);
    bool done = false;
    try {
      const std::vector<T> result = work();
      const char* at = reinterpret_cast<const char*>(result.data());
      std::size_t left = result.size() * sizeof(T);
      for (ssize_t written = 1; left > 0 && written > 0; at += written, left -= written)
        written = write(ends[1], at, left);
      done = left == 0;
    } catch (const std::exception& error) {
      std::cerr << error.what() << std::endl;
    }
    _exit(done ? 0 : 1);
  }
  close(ends[1]);
  std::string bytes;
  char buffer[1 << 16];
  for (ssize_t count; (count = read(ends[0], buffer, sizeof buffer)) > 0;) bytes.append(buffer, count);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) throw std::runtime_error("a measurement ended early: out of memory?");
  std::vector<T> result(bytes.size() / sizeof(T));
  if (!result.empty()) std::memcpy(result.data(), bytes.data(), result.size() * sizeof(T));
  return result;
}

/// Runs of ones, the mean over all orders of the columns: exact, for a row of k ones among n columns has
/// k (n - k + 1) / n on average.
inline double mean_runs_of_random(const VisibilityMatrix& matrix) {
  const double n = matrix.shape().columns;
  double sum = 0;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto k = static_cast<double>(matrix.row(r).size());
    if (k > 0) sum += k * (n - k + 1) / n;
  }
  return sum;
}

/// A line of comma-separated values.
inline std::string csv_line(const auto&... values) {
  std::ostringstream line;
  line << std::setprecision(12);
  ((line << values << ','), ...);
  std::string text = line.str();
  text.back() = '\n';
  return text;
}

/// Text that holds commas, as one value of csv_line.
inline std::string quoted(std::string_view text) {
  std::ostringstream out;
  out << std::quoted(text, '"', '"');
  return out.str();
}

/// What stands in a table already, or its first line.
inline std::string table_begin(const std::filesystem::path& path, std::string_view first_line, bool append) {
  if (!append || !std::filesystem::exists(path)) return std::string(first_line);
  const std::vector<std::byte> bytes = read_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// "artificial-1" of "out/data/artificial-1.bsp.h5".
inline std::string name_of(const std::filesystem::path& path) {
  const std::string name = path.filename();
  return name.substr(0, name.find(".bsp.h5"));
}

}  // namespace vismat::bench
