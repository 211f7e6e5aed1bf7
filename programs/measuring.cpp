#include "programs/measuring.h"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <span>
#include <stdexcept>

namespace vismat {
namespace {

double nth(std::vector<double>& values, std::size_t n) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// Throws what `work` throws.
bool write_result(int to, const std::function<std::vector<std::byte>()>& work) {
  const std::vector<std::byte> result = work();
  std::span<const std::byte> left = result;
  while (!left.empty()) {
    const ssize_t written = ::write(to, left.data(), left.size());
    if (written <= 0) return false;
    left = left.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  return values.empty() ? 0 : nth(values, values.size() / 2);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  return nth(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

Times time_passes(const Passes& passes, const std::function<void()>& work) {
  std::vector<double> times;
  const double begin = wall_seconds();
  do {
    times.push_back(seconds_of(work));
  } while (times.size() < passes.most && times.back() <= 5 * passes.seconds &&
           (times.size() < passes.least || wall_seconds() - begin < passes.seconds));
  const auto [least, most] = std::minmax_element(times.begin(), times.end());
  return {median(times), *least, *most, times.size()};
}

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::vector<std::byte> bytes_apart(const std::function<std::vector<std::byte>()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe to be had");
  std::fflush(stdout);
  ::malloc_trim(0);  // the child begins with what is in use alone
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no process to be had");
  if (child == 0) {
    ::close(ends[0]);
    bool done = false;
    try {
      done = write_result(ends[1], work);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
    ::_exit(done ? 0 : 1);
  }
  ::close(ends[1]);
  std::vector<std::byte> bytes;
  std::array<std::byte, 1 << 16> buffer;
  for (ssize_t count; (count = ::read(ends[0], buffer.data(), buffer.size())) > 0;)
    bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + count);
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (status != 0) throw std::runtime_error("a measurement ended early: out of memory?");
  return bytes;
}

}  // namespace vismat
