// How much a test repeats under sanitizers, which make it some ten times slower: as often as shows what they can see, which is
// every branch, and not as often as the statistics of a release build want.
#pragma once
#include <algorithm>

namespace vismat::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC; clang has the features instead
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
inline constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool sanitized = false;
#endif

/// How many trials of `count` are made; one at least.
template <typename Count>
constexpr Count trials(Count count) {
  return sanitized ? std::max(Count{1}, count / 5) : count;
}

}  // namespace vismat::test
