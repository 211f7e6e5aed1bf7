#include "programs/process.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "matrix/base/atomic_file.h"

namespace vismat {
namespace {

volatile std::sig_atomic_t pipe_was_closed = 0;

void interrupted(int signal, siginfo_t* info, void*) {
  // A write of this process into a pipe that nobody reads then fails, which the writer notices.
  if (signal == SIGPIPE && info->si_pid == ::getpid()) {
    pipe_was_closed = 1;
    return;
  }
  remove_partial_files();
  ::_exit(128 + signal);
}

}  // namespace

void begin_process() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", O_RDWR);
  }
  struct sigaction action {};
  action.sa_sigaction = interrupted;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;  // nohup
    ::sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file over its limit is an error to report, as a full disk is
}

int end_process(const std::string& program, int code) {
  errno = 0;
  std::cout.flush();
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (written || code != 0) return code;
  if (pipe_was_closed != 0) return 128 + SIGPIPE;
  if (errno == 0 && ::write(STDOUT_FILENO, "\n", 1) == 1)
    errno = EIO;  // the reason of an earlier failure is asked again
  std::fprintf(stderr, "%s: standard output: %s\n", program.c_str(), std::strerror(errno));
  return 1;
}

}  // namespace vismat
