// A partial file stands beside its final file, so that it can take its place in one step. Where the disk can do that it has
// no name until then (O_TMPFILE), and not even kill -9 leaves anything. Otherwise, and where a library opens it by name,
// it is FINAL.partial-XXXXXX with six random letters, made exclusively and kept locked; one that nobody has locked was
// left by a killed process, and the next that writes FINAL removes it.
#include "matrix/base/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace vismat {
namespace {

constexpr std::string_view mark = ".partial-";
constexpr std::size_t random_letters = 6;

// A fixed table of names, since a signal handler may neither lock nor allocate.
constexpr std::size_t slots = 16, longest = 4096;
struct Slot {
  std::atomic<bool> taken = false;
  std::atomic<bool> ready = false;
  std::array<char, longest> path;
};
std::array<Slot, slots> open_files;

[[noreturn]] void fail_at(const std::filesystem::path& path, const std::string& what, int error) {
  throw std::runtime_error(path.string() + ": " + what + ": " + std::strerror(error));
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

/// The number of an open descriptor of this process that the path names, such as /proc/self/fd/1; otherwise -1.
int descriptor_named(const std::filesystem::path& path) {
  std::error_code error;
  const auto own = std::filesystem::canonical("/proc/self/fd", error);
  if (error || std::filesystem::canonical(folder_of(path), error) != own || error) return -1;
  const std::string name = path.filename();
  int number = -1;
  const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool open = fault == std::errc() && end == name.data() + name.size() && ::fcntl(number, F_GETFD) >= 0;
  return open ? number : -1;
}

void remove_leftovers(const std::filesystem::path& final) {
  const std::string begin = final.filename().string() + std::string(mark);
  std::error_code error;
  std::filesystem::directory_iterator entries(folder_of(final), error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename();
    if (!name.starts_with(begin) || name.size() != begin.size() + random_letters) continue;
    const int file = ::open(entries->path().c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) continue;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlink(entries->path().c_str());
    ::close(file);
  }
}

}  // namespace

OutputTarget output_target(const std::filesystem::path& path) {
  OutputTarget target;
  target.path = path;
  for (int links = 0; links < 40; ++links) {
    target.descriptor = descriptor_named(target.path);
    if (target.descriptor >= 0) {
      target.kind = OutputTarget::Kind::device;
      return target;
    }
    struct stat status {};
    const bool exists = ::stat(target.path.c_str(), &status) == 0;
    std::error_code error;
    auto next = std::filesystem::read_symlink(target.path, error);
    bool followed = !error;
    if (followed && next.is_relative()) next = folder_of(target.path) / next;
    // Links in /proc lead to pipes by no path.
    if (followed && exists) followed = std::filesystem::exists(next, error);
    if (!followed) {
      using Kind = OutputTarget::Kind;
      target.kind = !exists                   ? Kind::nothing
                    : S_ISREG(status.st_mode) ? Kind::file
                    : S_ISDIR(status.st_mode) ? Kind::folder
                                              : Kind::device;
      return target;
    }
    target.path = next;
  }
  fail_at(path, "cannot write there", ELOOP);
}

AtomicFile::AtomicFile(std::filesystem::path path, Written written) : given_(std::move(path)) {
  const OutputTarget target = output_target(given_);
  final_ = target.path;
  if (target.kind == OutputTarget::Kind::folder) fail("cannot write there", EISDIR);
  device_ = target.kind == OutputTarget::Kind::device;
  if (!device_) {
    if (target.kind == OutputTarget::Kind::file && ::access(final_.c_str(), W_OK) != 0)
      fail("cannot write there", errno);
    open_partial(written);
    return;
  }
  if (written == Written::by_name)
    throw std::runtime_error(given_.string() + ": is no regular file, which this format needs");
  if (target.descriptor == STDOUT_FILENO) std::fflush(stdout);  // what was printed before comes first
  file_ = target.descriptor >= 0 ? ::fcntl(target.descriptor, F_DUPFD_CLOEXEC, 3)
                                 : ::open(final_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (file_ < 0) fail("cannot write there", errno);
}

AtomicFile::~AtomicFile() {
  if (!partial_.empty()) ::unlink(partial_.c_str());
  if (file_ >= 0) ::close(file_);
  release_slot();
}

void AtomicFile::open_partial(Written written) {
  try {
    if (written == Written::by_name || !open_nameless()) open_named();
    take_rights_of_the_old();
  } catch (...) {
    if (!partial_.empty()) ::unlink(partial_.c_str());
    if (file_ >= 0) ::close(file_);
    release_slot();
    throw;
  }
}

bool AtomicFile::open_nameless() {
  file_ = ::open(folder_of(final_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (file_ < 0) return false;
  if (::access(("/proc/self/fd/" + std::to_string(file_)).c_str(), F_OK) == 0) return true;
  ::close(std::exchange(file_, -1));
  return false;
}

void AtomicFile::open_named() {
  remove_leftovers(final_);
  for (;;) {
    new_partial_name();
    file_ = ::open(partial_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (file_ < 0 && errno == EEXIST) continue;
    if (file_ < 0) {
      const int error = errno;
      partial_.clear();
      fail("cannot write there", error);
    }
    ::flock(file_, LOCK_EX | LOCK_NB);
    // Another process may have taken it for a leftover before it was locked.
    struct stat status {};
    if (::fstat(file_, &status) == 0 && status.st_nlink > 0) return;
    ::close(std::exchange(file_, -1));
  }
}

// Before anything is written, so that nobody reads it who might not read the old one.
void AtomicFile::take_rights_of_the_old() {
  struct stat old {};
  if (::stat(final_.c_str(), &old) != 0) return;
  struct stat now {};
  if (::fstat(file_, &now) != 0) fail("cannot write there", errno);
  // Without the right to give files away, at least the group.
  if ((old.st_uid != now.st_uid || old.st_gid != now.st_gid) &&
      ::fchown(file_, old.st_uid, old.st_gid) != 0) {
    [[maybe_unused]] const int ignored = ::fchown(file_, static_cast<uid_t>(-1), old.st_gid);
  }
  if (::fchmod(file_, old.st_mode & 07777) != 0) fail("cannot take the old file's rights", errno);
}

// It goes into the table before the file exists, or a signal in between would leave the file behind.
void AtomicFile::new_partial_name() {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz012345";
  std::array<unsigned char, random_letters> random;
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    fail("no random name", errno);
  std::string name = final_.string() + std::string(mark);
  for (const unsigned char byte : random) name += letters[byte % letters.size()];
  partial_ = name;
  release_slot();
  for (std::size_t i = 0; i < slots && slot_ < 0 && partial_.native().size() < longest; ++i) {
    if (open_files[i].taken.exchange(true)) continue;
    std::strcpy(open_files[i].path.data(), partial_.c_str());
    open_files[i].ready = true;
    slot_ = static_cast<int>(i);
  }
}

void AtomicFile::release_slot() {
  if (slot_ < 0) return;
  open_files[static_cast<std::size_t>(slot_)].ready = false;
  open_files[static_cast<std::size_t>(slot_)].taken = false;
  slot_ = -1;
}

void AtomicFile::fail(const char* what, int error) const {
  fail_at(given_, what, error);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(file_, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail("cannot write", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
}

void AtomicFile::commit() {
  if (!device_ && partial_.empty()) {
    const std::string self = "/proc/self/fd/" + std::to_string(file_);
    do {
      new_partial_name();
      if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, partial_.c_str(), AT_SYMLINK_FOLLOW) == 0) break;
      const int error = errno;
      partial_.clear();
      if (error != EEXIST) fail("cannot take its final name", error);
    } while (true);
  }
  if (::close(std::exchange(file_, -1)) != 0) fail("cannot write", errno);
  if (device_) return;
  if (::rename(partial_.c_str(), final_.c_str()) != 0) fail("cannot take its final name", errno);
  partial_.clear();
  release_slot();
}

AtomicFileStream::AtomicFileStream(AtomicFile& file) : std::ostream(nullptr), buffer_(file) {
  rdbuf(&buffer_);
  exceptions(std::ios::badbit);
}

AtomicFileStream::Buffer::Buffer(AtomicFile& file) : file_(file) {
  setp(bytes_.data(), bytes_.data() + bytes_.size());
}

AtomicFileStream::Buffer::int_type AtomicFileStream::Buffer::overflow(int_type next) {
  sync();
  if (!traits_type::eq_int_type(next, traits_type::eof())) sputc(traits_type::to_char_type(next));
  return traits_type::not_eof(next);
}

int AtomicFileStream::Buffer::sync() {
  file_.write(std::as_bytes(std::span(pbase(), static_cast<std::size_t>(pptr() - pbase()))));
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  return 0;
}

void remove_partial_files() noexcept {
  for (const Slot& slot : open_files) {
    if (slot.ready) ::unlink(slot.path.data());
  }
}

std::vector<std::byte> read_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_at(path, "cannot open", errno);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || S_ISDIR(status.st_mode)) {
    ::close(descriptor);
    fail_at(path, "cannot read", S_ISDIR(status.st_mode) ? EISDIR : errno);
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
      fail_at(path, "cannot read", error);
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
  file.write(bytes);
  file.commit();
}

}  // namespace vismat
