#include "matrix/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace vismat {

void parallel_for(std::uint64_t count, unsigned threads, const std::function<void(std::uint64_t)>& work,
                  const Progress& progress) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  threads = static_cast<unsigned>(std::min<std::uint64_t>(threads, std::max<std::uint64_t>(count, 1)));
  std::atomic<std::uint64_t> next = 0;
  std::atomic<bool> stop = false;
  std::mutex mutex;  // guards error, done and calls of progress
  std::exception_ptr error;
  std::uint64_t done = 0;
  const auto run = [&] {
    for (std::uint64_t i; !stop && (i = next++) < count;) {
      try {
        work(i);
        if (progress) {
          const std::lock_guard lock(mutex);
          progress(++done, count);
        }
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        stop = true;
      }
    }
  };
  {
    std::vector<std::jthread> pool;
    pool.reserve(threads - 1);
    try {
      for (unsigned t = 1; t < threads; ++t) pool.emplace_back(run);
    } catch (const std::system_error&) {
      // The system gives no more threads; those there are do the work.
    }
    run();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace vismat
