// A verb in small, for jobs_test.py: jobs_toy OUTPUT THREADS MILLISECONDS [FAIL_AT]. Two stages of 60 pieces of random
// bytes, each of which takes so long; piece FAIL_AT of the second throws.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "matrix/base/atomic_file.h"
#include "matrix/base/random.h"
#include "programs/jobs.h"
#include "programs/progress.h"

namespace {

void run(const std::string& output, unsigned threads, unsigned milliseconds, std::uint64_t fail_at) {
  using namespace vismat;
  constexpr std::uint64_t count = 60;
  if (milliseconds > 10000) throw std::invalid_argument("at most 10000 milliseconds a piece");
  const std::unique_ptr<JobRunner> runner = cli::make_job_runner(threads);
  const std::unique_ptr<Journal> journal = cli::keep_journal(*runner, output, "toy");
  const auto toy = [&](std::uint64_t seed, std::uint64_t number) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    Random random(seed, number);
    JobRunner::Piece piece(number == 7 ? 3000000 : random.below(2000));
    for (std::byte& byte : piece) byte = static_cast<std::byte>(random.next());
    return piece;
  };
  const auto first = runner->run("first", count, [&](std::uint64_t i) { return toy(1, i); });
  const auto second = runner->run(
      "second", count,
      [&](std::uint64_t i) {
        if (i == fail_at) throw std::runtime_error("piece " + std::to_string(i) + " is broken");
        return toy(first[i].size(), i);
      },
      cli::show_progress("playing"));
  if (!runner->leads()) return;
  std::vector<std::byte> all;
  for (const auto& piece : second) all.insert(all.end(), piece.begin(), piece.end());
  write_file(output, all);
  journal->remove();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  std::signal(SIGXFSZ, SIG_IGN);  // as vismat does
  try {
    run(argv[1], static_cast<unsigned>(std::atoi(argv[2])), static_cast<unsigned>(std::atoi(argv[3])),
        argc > 4 ? std::strtoull(argv[4], nullptr, 10) : ~0ull);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "jobs_toy: %s\n", error.what());
    return 1;
  }
  return 0;
}
