// Runs loops over independent items on several threads.
#pragma once
#include <cstdint>
#include <functional>

namespace vismat {

/// Called now and then with how much is done of how much; from one thread at a time.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;
/// Called where a long stage of some work begins, with its name; gives that stage's progress.
using Stages = std::function<Progress(const char* stage)>;
inline Progress begin_stage(const Stages& stages, const char* stage) {
  return stages ? stages(stage) : Progress{};
}

/// Calls work(i) once for each i in [0, count), on `threads` threads (0: one a core). Items must not depend on one
/// another; which thread runs which is not fixed. The first exception thrown stops the loop and is rethrown.
void parallel_for(std::uint64_t count, unsigned threads, const std::function<void(std::uint64_t)>& work,
                  const Progress& progress = {});

}  // namespace vismat
