// Threads that work off numbered places, each of which is begun and waited for by one other thread.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace vismat {

/// Which thread works on which place, and when, is not fixed; places begin in the order of begin(). Allocates nothing
/// after construction.
class ReadThreads {
 public:
  /// `work(place)` is called by the threads and must not throw. Fewer threads if the system gives no more.
  ReadThreads(unsigned threads, std::uint32_t places, std::function<void(std::uint32_t)> work);
  /// Waits for what is being worked on; what has not begun is left out.
  ~ReadThreads();
  ReadThreads(const ReadThreads&) = delete;
  ReadThreads& operator=(const ReadThreads&) = delete;

  /// The place must not be at work. Everything written before is seen by the thread that works on it.
  void begin(std::uint32_t place);
  /// Waits until the place that was begun is done, or works on it itself; sees everything that was written for it. By
  /// one thread at a time.
  void finish(std::uint32_t place);
  /// What `threads` threads and `places` places allocate at most, stacks excepted.
  static std::uint64_t bytes(unsigned threads, std::uint32_t places);

 private:
  void run();

  std::function<void(std::uint32_t)> work_;
  std::mutex mutex_;
  std::condition_variable begun_, done_;
  std::vector<std::uint32_t> queue_;  // has room for all places, which are a few
  static constexpr std::uint32_t nobody = 0xffffffff;
  std::uint32_t awaited_ = nobody;
  std::vector<std::uint8_t> is_done_;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace vismat
