#include "programs/progress.h"

#include <unistd.h>

#include <cstdio>
#include <memory>
#include <utility>

namespace vismat::cli {
namespace {

using Clock = std::chrono::steady_clock;

std::string clock_time(double seconds) {
  char text[32];
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 60) {
    std::snprintf(text, sizeof text, "%ld s", whole);
  } else {
    std::snprintf(text, sizeof text, "%ld min %02ld s", whole / 60, whole % 60);
  }
  return text;
}

struct Line {
  std::string what;
  bool terminal = ::isatty(STDERR_FILENO) == 1;
  Clock::time_point start = Clock::now(), last = start;
  bool shown = false;

  void update(std::uint64_t done, std::uint64_t total) {
    const auto now = Clock::now();
    const auto pause =
        terminal ? std::chrono::milliseconds(shown ? 200 : 1000) : std::chrono::milliseconds(10000);
    const bool finished = done >= total;
    if (finished ? !shown : now - last < pause) return;
    last = now;
    shown = true;
    const double elapsed = std::chrono::duration<double>(now - start).count();
    const double part = total == 0 ? 1 : static_cast<double>(done) / static_cast<double>(total);
    std::string text = what + ": " + std::to_string(done) + " of " + std::to_string(total) + " (" +
                       std::to_string(static_cast<int>(part * 100)) + " %), ";
    text += finished ? "took " + clock_time(elapsed)
                     : clock_time(part > 0 ? elapsed * (1 - part) / part : 0) + " left";
    std::fprintf(stderr, terminal ? "\r\033[K%s%s" : "%s%s", text.c_str(), finished || !terminal ? "\n" : "");
    std::fflush(stderr);
  }
};

}  // namespace

Progress show_progress(std::string what) {
  auto line = std::make_shared<Line>();
  line->what = std::move(what);
  return [line](std::uint64_t done, std::uint64_t total) { line->update(done, total); };
}

}  // namespace vismat::cli
