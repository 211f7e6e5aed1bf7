#include "tests/cli/program_fixture.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "matrix/files/dataset_file.h"

namespace vismat {
namespace {

std::string contents_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whether the call changes what a folder or a file holds. Sanitizers write to pipes of their own, before main() too.
bool changes_files(pid_t child, const __ptrace_syscall_info& call) {
  const auto argument = [&](int i) { return static_cast<unsigned long>(call.entry.args[i]); };
  switch (call.entry.nr) {
    case SYS_openat:
      return (argument(2) & (O_CREAT | O_TRUNC)) != 0 || (argument(2) & O_TMPFILE) == O_TMPFILE;
    case SYS_write:
    case SYS_writev:
    case SYS_pwrite64:
    case SYS_ftruncate:
    case SYS_fchmod:
      return std::filesystem::is_regular_file("/proc/" + std::to_string(child) + "/fd/" +
                                              std::to_string(argument(0)));
    case SYS_linkat:
    case SYS_renameat2:
    case SYS_unlinkat:
      return true;
#ifdef SYS_rename
    case SYS_rename:
    case SYS_unlink:
      return true;
#endif
    default:
      return false;
  }
}

/// Sends SIGINT to a child that asked to be traced before exec, at the entry of its call that makes change number `changes`, so that
/// the signal meets it right after; then lets it go on alone. Counts in `made`; true if the child ended before, with `status`.
bool interrupt_at(pid_t child, unsigned changes, unsigned& made, int& status) {
  for (bool begun = false; ::waitpid(child, &status, 0) == child && WIFSTOPPED(status); begun = true) {
    long signal = 0;
    if (!begun) {  // at exec
      ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
    } else if (WSTOPSIG(status) != (SIGTRAP | 0x80)) {
      signal = WSTOPSIG(status);
    } else {
      __ptrace_syscall_info call{};
      ::ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof(call), &call);
      if (call.op == PTRACE_SYSCALL_INFO_ENTRY && changes_files(child, call) && ++made == changes) {
        ::kill(child, SIGINT);
        ::ptrace(PTRACE_DETACH, child, nullptr, 0);
        return false;
      }
    }
    ::ptrace(PTRACE_SYSCALL, child, nullptr, signal);
  }
  return true;
}

}  // namespace

Finished Program::vismat(const std::string& words, unsigned changes) const {
  const TemporaryFolder told;
  const std::string out = told / "out", error = told / "error", work = folder / "";
  std::istringstream split(words);
  std::vector<std::string> all = {VISMAT_PROGRAM};
  all.insert(all.end(), std::istream_iterator<std::string>(split), {});
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::setpgid(0, 0);
    ::dup2(::open(out.c_str(), O_CREAT | O_WRONLY, 0600), STDOUT_FILENO);
    ::dup2(::open(error.c_str(), O_CREAT | O_WRONLY, 0600), STDERR_FILENO);
    if (changes > 0) {
      ::setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // which takes tracing for itself
      ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    }
    if (::chdir(work.c_str()) == 0) ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::setpgid(child, child);  // whichever of the two is first
  int status = 0;
  unsigned made = 0;
  if (changes == 0 || !interrupt_at(child, changes, made, status)) ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents_of(out), contents_of(error), made};
}

Finished Program::vismat_succeeds(const std::string& words) const {
  const Finished run = vismat(words);
  EXPECT_EQ(run.code, 0) << "vismat " << words << "\n" << run.error;
  return run;
}

void Program::expect_refusal(const std::string& words, const std::string& why) const {
  const std::size_t files = folder.entries();
  const Finished run = vismat(words);
  SCOPED_TRACE("vismat " + words + "\n" + run.out + run.error);
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(run.error.starts_with("vismat: "));
  EXPECT_TRUE(contains(run.error, why)) << why;
  EXPECT_EQ(count_lines(run.error), 1u);
  EXPECT_EQ(folder.entries(), files) << "left a file";
}

void Program::write(const std::string& file, const std::string& text) const {
  std::ofstream(folder / file) << text;
}
void Program::write(const std::string& file, const Dataset& dataset) const {
  write_dataset(folder / file, dataset);
}
std::string Program::contents(const std::string& file) const {
  return contents_of(folder / file);
}
Dataset Program::dataset(const std::string& file) const {
  return read_dataset(folder / file);
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

Dataset ring_of_clusters(std::uint32_t count) {
  Dataset dataset;
  std::vector<std::vector<std::uint32_t>> rows(count);
  for (std::uint32_t r = 0; r < count; ++r) {
    const auto at = static_cast<float>(r * 7 % count);
    dataset.row_bounds.push_back({{at, 0, 0}, {at + 1, 1, 1}});
    for (std::uint32_t c = 0; c < count; ++c) {
      const std::uint32_t apart = (c * 7 % count + count - r * 7 % count) % count;
      if (apart < 9 || apart > count - 9) rows[r].push_back(c);
    }
  }
  dataset.column_bounds = dataset.row_bounds;
  dataset.matrix = VisibilityMatrix::from_rows(rows, count);
  dataset.guarantee = Guarantee::exact;
  return dataset;
}

std::string printed_row(const VisibilityMatrix& matrix, std::uint32_t row) {
  std::string ids;
  for (const std::uint32_t id : matrix.row(row)) ids += std::to_string(id) + "\n";
  return ids;
}

}  // namespace vismat
