// ALGORITHM. A log that is only ever appended to, each record with its checksum. A record is one write, so a kill leaves
// at most one torn record, at the end; a failed write is cut off at once. Bytes are little-endian:
//
//   head    magic (8), checksum of what follows (4), size of work (4), work
//   record  checksum of what follows (4), size of stage (4), number (8), size of piece (8), stage, piece
//
// Nothing is synced to the disk: the system keeps what was written when a process dies. After a power cut, what the disk
// did not get fails its checksum and is made again.
#include "visibility/jobs/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/base/checksum.h"

namespace vismat {
namespace {

constexpr std::string_view magic = "vismatJ1";

template <typename Number>
void put(std::vector<std::byte>& bytes, Number number) {
  const auto raw = std::as_bytes(std::span(&number, 1));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

void put(std::vector<std::byte>& bytes, std::string_view text) {
  const auto raw = std::as_bytes(std::span(text));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

// Over all that follows the 4 bytes at `at`.
void seal(std::vector<std::byte>& bytes, std::size_t at) {
  const std::uint32_t sum = crc32(std::span(bytes).subspan(at + 4));
  std::memcpy(bytes.data() + at, &sum, 4);
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Both without the parts, between commas and semicolons, that they begin or end with in common.
std::pair<std::string_view, std::string_view> differing_parts(std::string_view a, std::string_view b) {
  const auto ends_a_part = [](char c) { return c == ';' || c == ','; };
  const std::size_t shorter = std::min(a.size(), b.size());
  std::size_t begin = 0, end = 0;
  for (std::size_t i = 0; i < shorter && a[i] == b[i]; ++i) {
    if (a[i] == ' ' && i > 0 && ends_a_part(a[i - 1])) begin = i + 1;
  }
  for (std::size_t i = 0; i < shorter - begin && a[a.size() - 1 - i] == b[b.size() - 1 - i]; ++i) {
    if (ends_a_part(a[a.size() - 1 - i])) end = i + 1;
  }
  return {a.substr(begin, a.size() - begin - end), b.substr(begin, b.size() - begin - end)};
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what, int error) {
  throw std::runtime_error(path.string() + ": " + what + ": " + std::strerror(error));
}

}  // namespace

std::vector<std::byte> journal_head(std::string_view work) {
  std::vector<std::byte> head;
  put(head, magic);
  put(head, std::uint32_t{0});
  put(head, static_cast<std::uint32_t>(work.size()));
  put(head, work);
  seal(head, magic.size());
  return head;
}

std::vector<std::byte> journal_record(const JournalContents::Record& record) {
  std::vector<std::byte> bytes;
  bytes.reserve(24 + record.stage.size() + record.piece.size());
  put(bytes, std::uint32_t{0});
  put(bytes, static_cast<std::uint32_t>(record.stage.size()));
  put(bytes, record.number);
  put(bytes, std::uint64_t{record.piece.size()});
  put(bytes, record.stage);
  bytes.insert(bytes.end(), record.piece.begin(), record.piece.end());
  seal(bytes, 0);
  return bytes;
}

JournalContents read_journal(std::span<const std::byte> bytes) {
  JournalContents contents;
  ByteReader in(bytes, "journal");
  if (in.left() < magic.size() + 8 || text_of(in.bytes(magic.size())) != magic) {
    throw FormatError("not a journal of vismat; one begins with " + std::string(magic));
  }
  const auto head_sum = in.number<std::uint32_t>();
  const auto work_size = in.number<std::uint32_t>();
  contents.work = text_of(in.bytes(work_size));
  if (crc32(bytes.subspan(magic.size() + 4, 4 + std::size_t{work_size})) != head_sum) {
    throw FormatError("the journal's head is damaged");
  }
  for (;;) {
    contents.end = in.offset();
    if (in.left() < 24) return contents;
    const auto sum = in.number<std::uint32_t>();
    const auto stage_size = in.number<std::uint32_t>();
    JournalContents::Record record;
    record.number = in.number<std::uint64_t>();
    const auto piece_size = in.number<std::uint64_t>();
    if (stage_size > in.left() || piece_size > in.left() - stage_size) return contents;
    record.stage = text_of(in.bytes(stage_size));
    record.piece = in.bytes(piece_size);
    if (crc32(bytes.subspan(contents.end + 4, in.offset() - contents.end - 4)) != sum) return contents;
    contents.records.push_back(record);
  }
}

Journal::Journal(std::filesystem::path path, const std::string& work) : path_(std::move(path)) {
  for (;;) {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
    if (file_ < 0) fail(path_, "cannot write there", errno);
    if (lock()) break;
    ::close(file_);
  }
  try {
    begin_or_read(work);
  } catch (...) {
    close();
    throw;
  }
}

Journal::~Journal() {
  if (begun_.empty() && empty()) remove();  // the work was refused before it began
  close();
}

void Journal::close() {
  if (!mapped_.empty()) ::munmap(const_cast<std::byte*>(mapped_.data()), mapped_.size());
  ::close(file_);
}

// False if another run removed the file between its being opened and locked.
bool Journal::lock() {
  try {
    struct stat status {
    }, named{};
    if (::fstat(file_, &status) != 0) fail(path_, "cannot read", errno);
    if (!S_ISREG(status.st_mode)) throw std::invalid_argument(path_.string() + ": is no regular file");
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      if (errno != EWOULDBLOCK) fail(path_, "cannot lock", errno);
      throw std::invalid_argument(path_.string() + ": another run is at this work");
    }
    return ::stat(path_.c_str(), &named) == 0 && named.st_ino == status.st_ino &&
           named.st_dev == status.st_dev;
  } catch (...) {
    ::close(file_);
    throw;
  }
}

void Journal::begin_or_read(const std::string& work) {
  struct stat status {};
  if (::fstat(file_, &status) != 0) fail(path_, "cannot read", errno);
  const auto size = static_cast<std::size_t>(status.st_size);
  const std::vector<std::byte> head = journal_head(work);
  head_end_ = head.size();
  if (size > 0) {
    void* const address = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file_, 0);
    if (address == MAP_FAILED) fail(path_, "cannot read", errno);
    mapped_ = {static_cast<const std::byte*>(address), size};
  }
  if (size < head.size() && std::equal(mapped_.begin(), mapped_.end(), head.begin())) {  // new, or torn
    if (::ftruncate(file_, 0) != 0) fail(path_, "cannot write", errno);
    try {
      return append(head);
    } catch (...) {
      remove();
      throw;
    }
  }
  JournalContents contents;
  try {
    contents = read_journal(mapped_);
  } catch (const FormatError& error) {
    throw FormatError(path_.string() + ": " + error.what());
  }
  if (contents.work != work) {
    if (contents.records.empty()) {  // nothing is lost by beginning anew
      if (::ftruncate(file_, 0) != 0) fail(path_, "cannot write", errno);
      return append(head);
    }
    const auto [theirs, ours] = differing_parts(contents.work, work);
    throw std::invalid_argument(
        path_.string() + ": holds " + std::to_string(contents.records.size()) +
        " finished pieces of other work: '" + std::string(theirs) + "' where this has '" + std::string(ours) +
        "'; repeat the old command to go on with it, or remove the file to begin anew");
  }
  if (::ftruncate(file_, static_cast<off_t>(contents.end)) != 0) fail(path_, "cannot write", errno);
  end_ = contents.end;
  found_ = contents.records.size();
  for (const auto& [stage, number, piece] : contents.records) {
    left_[std::string(stage)].emplace_back(number, piece);
  }
}

std::vector<std::uint64_t> Journal::restore(const std::string& stage, std::vector<JobRunner::Piece>& pieces) {
  if (!begun_.insert(stage).second) throw std::logic_error("the stage '" + stage + "' twice in one run");
  std::vector<bool> have(pieces.size());
  if (const auto at = left_.find(stage); at != left_.end()) {
    for (const auto& [number, piece] : at->second) {
      if (number >= pieces.size()) {
        throw FormatError(path_.string() + ": piece " + std::to_string(number) + " of " + stage +
                          ", which has " + std::to_string(pieces.size()));
      }
      pieces[number].assign(piece.begin(), piece.end());
      have[number] = true;
    }
    left_.erase(at);
  }
  std::vector<std::uint64_t> missing;
  for (std::uint64_t i = 0; i < pieces.size(); ++i) {
    if (!have[i]) missing.push_back(i);
  }
  return missing;
}

void Journal::store(const std::string& stage, std::uint64_t number, const JobRunner::Piece& piece) {
  append(journal_record({stage, number, piece}));
}

void Journal::append(std::span<const std::byte> bytes) {
  const std::lock_guard lock(mutex_);
  std::uint64_t at = end_;
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      const int error = errno;
      // What cannot be cut off fails its checksum, so the answer changes nothing.
      [[maybe_unused]] const int ignored = ::ftruncate(file_, static_cast<off_t>(end_));
      fail(path_, "cannot store more (what is stored stays, and the same command goes on from there)", error);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    at += static_cast<std::uint64_t>(put);
  }
  end_ = at;
}

void Journal::remove() {
  if (!std::exchange(removed_, true)) ::unlink(path_.c_str());
}

}  // namespace vismat
