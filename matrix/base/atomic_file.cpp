#include "matrix/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismat {
namespace {

// A fixed table of names, since a signal handler may neither lock nor allocate.
constexpr std::size_t slots = 16, longest = 4096;
struct Slot {
  std::atomic<bool> taken = false;
  std::atomic<bool> ready = false;
  std::array<char, longest> path;
};
std::array<Slot, slots> open_files;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what, int error) {
  throw std::runtime_error(path.string() + ": " + what + ": " + std::strerror(error));
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path final_path) : final_(std::move(final_path)) {
  partial_ = final_;
  partial_ += ".partial-" + std::to_string(::getpid());
  // The name goes into the table before the file exists, or a signal in between would leave the file behind.
  for (std::size_t i = 0; i < slots && slot_ < 0 && partial_.native().size() < longest; ++i) {
    if (open_files[i].taken.exchange(true)) continue;
    std::strcpy(open_files[i].path.data(), partial_.c_str());
    open_files[i].ready = true;
    slot_ = static_cast<int>(i);
  }
  const int descriptor = ::open(partial_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const int error = errno;
    release_slot();
    fail(final_, "cannot write there", error);
  }
  ::close(descriptor);
}

AtomicFile::~AtomicFile() {
  if (!partial_.empty()) ::unlink(partial_.c_str());
  release_slot();
}

void AtomicFile::release_slot() {
  if (slot_ < 0) return;
  open_files[static_cast<std::size_t>(slot_)].ready = false;
  open_files[static_cast<std::size_t>(slot_)].taken = false;
}

void AtomicFile::commit() {
  if (::rename(partial_.c_str(), final_.c_str()) != 0) fail(final_, "cannot take its final name", errno);
  partial_.clear();
}

void remove_partial_files() noexcept {
  for (const Slot& slot : open_files) {
    if (slot.ready) ::unlink(slot.path.data());
  }
}

std::vector<std::byte> read_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path, "cannot open", errno);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || S_ISDIR(status.st_mode)) {
    ::close(descriptor);
    fail(path, "cannot read", S_ISDIR(status.st_mode) ? EISDIR : errno);
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::max<off_t>(status.st_size, 0)));
  std::size_t have = 0;
  for (;;) {
    if (have == bytes.size()) bytes.resize(have + 65536);  // pipes, or a file that grew
    const ssize_t got = ::read(descriptor, bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      const int error = errno;
      ::close(descriptor);
      fail(path, "cannot read", error);
    }
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  ::close(descriptor);
  bytes.resize(have);
  return bytes;
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  const int descriptor = ::open(file.partial_path().c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path, "cannot write", errno);
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      const int error = errno;
      ::close(descriptor);
      fail(path, "cannot write", error);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  if (::close(descriptor) != 0) fail(path, "cannot write", errno);
  file.commit();
}

}  // namespace vismat
