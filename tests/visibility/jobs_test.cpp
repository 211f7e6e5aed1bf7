// JobRunners with and without a journal: the same bytes for any number of threads and after any end of earlier runs.
#include "visibility/jobs/job_runner.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "tests/matrix/temporary_folder.h"
#include "visibility/jobs/journal.h"

namespace vismat {
namespace {

using Pieces = std::vector<JobRunner::Piece>;
constexpr std::uint64_t count = 40;

JobRunner::Piece toy_piece(std::uint64_t seed, std::uint64_t number) {
  Random random(seed, number);
  JobRunner::Piece piece(random.below(200));  // one in 200 is empty
  for (std::byte& byte : piece) byte = static_cast<std::byte>(random.next());
  return piece;
}

// Two stages; the second depends on what the first gave. `made` counts what was not restored.
Pieces work(JobRunner& runner, const std::function<void()>& made = {}) {
  const auto toy = [&](std::uint64_t seed) {
    return [seed, made](std::uint64_t i) {
      if (made) made();
      return toy_piece(seed, i);
    };
  };
  const Pieces first = runner.run("first", count, toy(1));
  Pieces all = runner.run("second", 2 * count, toy(first[1].size()));
  all.insert(all.end(), first.begin(), first.end());
  return all;
}

Pieces expected() {
  ThreadJobRunner runner(1);
  return work(runner);
}

TEST(JobRunner, GivesTheSameBytesForAnyNumberOfThreads) {
  const Pieces one = expected();
  ASSERT_EQ(one.size(), 3 * count);
  EXPECT_EQ(one[5], toy_piece(one[2 * count + 1].size(), 5));
  for (const unsigned threads : {2u, 5u}) {
    ThreadJobRunner runner(threads);
    EXPECT_EQ(work(runner), one);
  }
}

TEST(JobRunner, RestoresEveryPieceThatAJournalHolds) {
  const TemporaryFolder folder;
  for (const unsigned threads : {3u, 2u}) {
    Journal journal(folder / "j", "toy");
    ThreadJobRunner runner(threads);
    runner.keep_in(journal);
    std::atomic<std::uint64_t> made = 0;
    EXPECT_EQ(work(runner, [&] { ++made; }), expected());
    EXPECT_EQ(made, threads == 3 ? 3 * count : 0);
    EXPECT_EQ(journal.found(), threads == 3 ? 0 : 3 * count);
  }
  Journal(folder / "j", "toy").remove();
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(JobRunner, GoesOnAfterAKill) {
  const TemporaryFolder folder;
  for (std::uint64_t already = 0; already < 3 * count; already += 17) {
    const pid_t child = ::fork();
    if (child == 0) {
      Journal journal(folder / "j", "toy");
      ThreadJobRunner runner(2);
      runner.keep_in(journal);
      std::atomic<int> made = 0;
      work(runner, [&] {
        if (++made == 19) ::kill(::getpid(), SIGKILL);  // 17 or 18 stored
      });
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) || already > 2 * count) << "the run ended early";
    if (!WIFSIGNALED(status)) break;
  }
  Journal journal(folder / "j", "toy");
  EXPECT_GE(journal.found(), 2 * count);
  ThreadJobRunner runner(2);
  runner.keep_in(journal);
  EXPECT_EQ(work(runner), expected());
}

TEST(JobRunner, GoesOnFromAJournalCutAnywhereAndFromADamagedOne) {
  const TemporaryFolder folder;
  const auto run = [&](std::span<const std::byte> left) {
    write_file(folder / "j", left);
    Journal journal(folder / "j", "toy");
    ThreadJobRunner runner(1);
    runner.keep_in(journal);
    return runner.run("first", 5, [](std::uint64_t i) { return toy_piece(1, i); });
  };
  const Pieces right = run({});
  const std::vector<std::byte> whole = read_file(folder / "j");
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    ASSERT_EQ(run(std::span(whole).first(size)), right) << size;
    ASSERT_EQ(read_file(folder / "j"), whole) << size;
  }
  const std::size_t head = journal_head("toy").size();
  for (std::size_t at = head; at < whole.size(); at += 7) {
    std::vector<std::byte> damaged = whole;
    damaged[at] ^= std::byte{0x10};
    ASSERT_EQ(run(damaged), right) << at;
  }
}

TEST(JobRunner, AJournalServesOneWorkAndOneRun) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& work) -> std::string {
    try {
      Journal journal(folder / "j", work);
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  };
  {
    Journal journal(folder / "j", "toy, seed 1");
    EXPECT_NE(refusal("toy, seed 1").find("another run is at this work"), std::string::npos);
    journal.store("first", 3, toy_piece(1, 3));
    Pieces pieces(10);
    journal.restore("second", pieces);
    EXPECT_THROW(journal.restore("second", pieces), std::logic_error);
  }
  EXPECT_NE(refusal("toy, seed 2").find("'seed 1' where this has 'seed 2'; repeat the old command"),
            std::string::npos);
  EXPECT_EQ(refusal("toy, seed 1"), "");
  Journal journal(folder / "j", "toy, seed 1");
  Pieces pieces(3);
  EXPECT_THROW(journal.restore("first", pieces), FormatError);  // piece 3 of 3
  write_file(folder / "other", std::as_bytes(std::span("a text that is no journal at all")));
  EXPECT_THROW(Journal(folder / "other", "toy"), FormatError);
  EXPECT_THROW(Journal(folder / "no folder/j", "toy"), std::runtime_error);
}

TEST(JobRunner, AJournalWithoutPiecesStandsInNobodysWay) {
  const TemporaryFolder folder;
  { const Journal journal(folder / "j", "toy"); }
  EXPECT_EQ(folder.entries(), 0u);
  write_file(folder / "j", journal_head("other work that was killed at once"));
  {
    Journal journal(folder / "j", "toy");
    EXPECT_EQ(journal.found(), 0u);
    journal.store("first", 1, toy_piece(1, 1));
  }
  EXPECT_EQ(Journal(folder / "j", "toy").found(), 1u);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(Journal(folder / "pipe", "toy"), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
}

TEST(JobRunner, AFullDiskEndsTheRunAndTheNextGoesOn) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {  // a limit on the size of files is the full disk that needs no rights
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4000, 4000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    Journal journal(folder / "j", "toy");
    ThreadJobRunner runner(2);
    runner.keep_in(journal);
    try {
      work(runner);
    } catch (const std::runtime_error& error) {
      ::_exit(std::strstr(error.what(), "File too large") != nullptr ? 7 : 8);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
  Journal journal(folder / "j", "toy");
  EXPECT_GT(journal.found(), 20u);
  ThreadJobRunner runner(2);
  runner.keep_in(journal);
  EXPECT_EQ(work(runner), expected());
}

}  // namespace
}  // namespace vismat
