#include "runtime/storage/read_threads.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace vismat {

ReadThreads::ReadThreads(unsigned threads, std::uint32_t places, std::function<void(std::uint32_t)> work)
    : work_(std::move(work)), is_done_(places, 0) {
  queue_.reserve(places);
  threads_.reserve(threads);
  try {
    for (unsigned t = 0; t < threads; ++t) threads_.emplace_back(&ReadThreads::run, this);
  } catch (const std::system_error&) {  // as many as there are; finish() works itself, too
  }
}

ReadThreads::~ReadThreads() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  begun_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ReadThreads::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    begun_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (stop_) return;
    const std::uint32_t place = queue_.front();
    queue_.erase(queue_.begin());
    lock.unlock();
    work_(place);
    lock.lock();
    is_done_[place] = 1;
    if (awaited_ == place) done_.notify_one();
  }
}

void ReadThreads::begin(std::uint32_t place) {
  {
    const std::lock_guard lock(mutex_);
    is_done_[place] = 0;
    queue_.push_back(place);
  }
  begun_.notify_one();
}

void ReadThreads::finish(std::uint32_t place) {
  std::unique_lock lock(mutex_);
  const auto queued = std::ranges::find(queue_, place);
  if (queued != queue_.end()) {  // nobody has come to it
    queue_.erase(queued);
    lock.unlock();
    work_(place);
    return;
  }
  awaited_ = place;
  done_.wait(lock, [this, place] { return is_done_[place] != 0; });
  awaited_ = nobody;
}

std::uint64_t ReadThreads::bytes(unsigned threads, std::uint32_t places) {
  constexpr std::uint64_t state_of_a_thread =
      64;  // what std::thread keeps for the call: 32 bytes with libstdc++
  return sizeof(ReadThreads) + places * std::uint64_t{sizeof(std::uint32_t) + 1} +
         threads * (sizeof(std::thread) + state_of_a_thread);
}

}  // namespace vismat
