// How much a test repeats under sanitizers, which make it some ten times slower: as often as shows what they can see, which is
// every branch, and not as often as the statistics of a release build want.
#pragma once

namespace vismat::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
#else
inline constexpr bool sanitized = false;
#endif

/// How many trials of `count` are made; one at least.
constexpr int trials(int count, int less = 5) {
  return !sanitized ? count : count < less ? 1 : count / less;
}

}  // namespace vismat::test
