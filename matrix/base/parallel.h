// Runs loops over independent items on several threads.
#pragma once
#include <cstdint>
#include <functional>

namespace vismat {

/// Is called now and then with how much of the work is done; by one thread at a time.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;
/// Is called where a long stage of some work begins, with the stage's name; returns that stage's progress.
using Stages = std::function<Progress(const char* stage)>;
inline Progress begin_stage(const Stages& stages, const char* stage) {
  return stages ? stages(stage) : Progress{};
}

/// Calls work(i) once for each i in [0, count), on `threads` threads (0: one for each core), or on fewer if the system
/// gives no more. Items must not depend on one another; which thread runs which item is not fixed. The first exception that is thrown stops the loop and is
/// rethrown.
void parallel_for(std::uint64_t count, unsigned threads, const std::function<void(std::uint64_t)>& work,
                  const Progress& progress = {});

}  // namespace vismat
