// The index stands behind the chunks, so that a store is written in one go, whatever the chunks' sizes turn out to be, and that
// nothing is kept in memory but the index.
#include "runtime/storage/chunk_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "matrix/base/checksum.h"

namespace vismat {
namespace {

constexpr std::array<std::uint8_t, 8> store_magic{0x89, 'V', 'C', 'H', 'K', '\r', '\n', 0x1a};
constexpr std::uint32_t store_version = 1, store_page = 4096, longest_contents = 1000;
constexpr std::size_t fixed_head = 28, entry_bytes = 16, checksum_bytes = 4;

bool is_line_of_text(std::string_view text) {
  return !text.empty() && text.size() <= longest_contents &&
         std::ranges::none_of(text, [](unsigned char letter) { return letter < 0x20 || letter == 0x7f; });
}

template <typename Number>
void append_number(std::vector<std::byte>& bytes, Number number) {
  const auto raw = std::as_bytes(std::span(&number, 1));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

template <typename Number>
void put_number(std::vector<std::byte>& bytes, std::size_t at, Number number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

std::string chunk_name(std::uint32_t chunk) {
  return "chunk " + std::to_string(chunk);
}

}  // namespace

ChunkStoreWriter::ChunkStoreWriter(const std::filesystem::path& path, std::string_view contents,
                                   std::uint32_t scene_checksum, std::uint32_t chunk_count)
    : file_(path), stream_(file_), appended_(chunk_count, false) {
  if (!is_line_of_text(contents))
    throw std::invalid_argument("what the chunks are must be one line of 1 to 1000 bytes");
  const auto magic = std::as_bytes(std::span(store_magic));
  head_and_index_.assign(magic.begin(), magic.end());
  for (const std::uint32_t number :
       {store_version, scene_checksum, store_page, chunk_count, static_cast<std::uint32_t>(contents.size())})
    append_number(head_and_index_, number);
  const auto text = std::as_bytes(std::span(contents));
  head_and_index_.insert(head_and_index_.end(), text.begin(), text.end());
  head_bytes_ = head_and_index_.size();
  head_and_index_.resize(head_bytes_ + entry_bytes * chunk_count);
  put(std::span(head_and_index_).first(head_bytes_));
}

void ChunkStoreWriter::put(std::span<const std::byte> bytes) {
  stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  end_ += bytes.size();
}

void ChunkStoreWriter::append(std::uint32_t chunk, std::span<const std::byte> bytes) {
  if (chunk >= appended_.size())
    throw std::invalid_argument(chunk_name(chunk) + " of " + std::to_string(appended_.size()) +
                                " does not exist");
  if (appended_[chunk]) throw std::invalid_argument(chunk_name(chunk) + " was already appended");
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument(chunk_name(chunk) + " has 2^32 bytes or more");
  appended_[chunk] = true;
  const std::size_t at = head_bytes_ + entry_bytes * chunk;
  put_number(head_and_index_, at, end_);
  put_number(head_and_index_, at + 8, static_cast<std::uint32_t>(bytes.size()));
  put_number(head_and_index_, at + 12, crc32(bytes));
  put(bytes);
}

void ChunkStoreWriter::finish() {
  const auto missing = std::ranges::find(appended_, false);
  if (missing != appended_.end()) {
    throw std::invalid_argument(chunk_name(static_cast<std::uint32_t>(missing - appended_.begin())) +
                                " was not appended");
  }
  put(std::span(head_and_index_).subspan(head_bytes_));
  const std::uint32_t checksum = crc32(head_and_index_);
  put(std::as_bytes(std::span(&checksum, 1)));
  stream_.flush();
  file_.commit();
}

ChunkStore::ChunkStore(std::filesystem::path path) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw std::runtime_error(path_.string() + ": cannot open: " + std::strerror(errno));
  try {
    naming(path_, [this] { read_index(); });
  } catch (...) {
    ::close(file_);
    throw;
  }
}

ChunkStore::~ChunkStore() {
  if (file_ >= 0) ::close(file_);
}

ChunkStore::ChunkStore(ChunkStore&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      scene_checksum_(other.scene_checksum_),
      contents_(std::move(other.contents_)),
      entries_(std::move(other.entries_)) {}

ChunkStore& ChunkStore::operator=(ChunkStore&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(file_, other.file_);
  std::swap(scene_checksum_, other.scene_checksum_);
  std::swap(contents_, other.contents_);
  std::swap(entries_, other.entries_);
  return *this;
}

std::size_t ChunkStore::read_some(std::uint64_t offset, std::span<std::byte> memory) const {
  std::size_t done = 0;
  while (done < memory.size()) {
    const ssize_t count =
        ::pread(file_, memory.data() + done, memory.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::runtime_error(path_.string() + ": cannot read: " + std::strerror(errno));
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

std::vector<std::byte> ChunkStore::bytes_at(std::uint64_t offset, std::size_t count) const {
  std::vector<std::byte> bytes(count);
  if (read_some(offset, bytes) != count) throw FormatError("was cut while it was read");
  return bytes;
}

void ChunkStore::read_index() {
  struct stat status {};
  if (::fstat(file_, &status) != 0)
    throw std::runtime_error(path_.string() + ": cannot read: " + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw std::runtime_error(path_.string() + ": is no regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  std::vector<std::byte> head =
      bytes_at(0, static_cast<std::size_t>(std::min<std::uint64_t>(size, fixed_head)));
  const auto magic = std::as_bytes(std::span(store_magic));
  if (head.size() < magic.size() || !std::ranges::equal(magic, std::span(head).first(magic.size())))
    throw FormatError("offset 0: is no store of chunks");
  if (head.size() < fixed_head) throw FormatError("ends within its head");
  const auto version = number_at<std::uint32_t>(head, 8), page = number_at<std::uint32_t>(head, 16),
             count = number_at<std::uint32_t>(head, 20), text = number_at<std::uint32_t>(head, 24);
  if (version != store_version)
    throw FormatError("offset 8: version " + std::to_string(version) + "; this program reads version 1");
  if (page != store_page)
    throw FormatError("offset 16: pages of " + std::to_string(page) + " bytes, not 4096");
  if (text < 1 || text > longest_contents)
    throw FormatError("offset 24: a text of " + std::to_string(text) + " bytes, not 1 to 1000");
  const std::uint64_t head_end = fixed_head + text, index_bytes = entry_bytes * std::uint64_t{count};
  if (size < head_end + index_bytes + checksum_bytes) {
    throw FormatError("has " + std::to_string(size) + " bytes, too few for its head and the index of " +
                      std::to_string(count) + " chunks: it was cut, or is damaged");
  }
  const std::uint64_t index_begin = size - checksum_bytes - index_bytes;
  const std::vector<std::byte> line = bytes_at(fixed_head, text),
                               index = bytes_at(index_begin, static_cast<std::size_t>(index_bytes)),
                               checksum = bytes_at(size - checksum_bytes, checksum_bytes);
  head.insert(head.end(), line.begin(), line.end());
  head.insert(head.end(), index.begin(), index.end());
  if (crc32(head) != number_at<std::uint32_t>(checksum, 0))
    throw FormatError("the checksum of its head and index is not right: it was cut, or is damaged");
  contents_.assign(reinterpret_cast<const char*>(line.data()), line.size());
  if (!is_line_of_text(contents_)) throw FormatError("offset 28: control characters in what the chunks are");
  scene_checksum_ = number_at<std::uint32_t>(head, 12);

  entries_.resize(count);
  for (std::uint32_t chunk = 0; chunk < count; ++chunk) {
    const std::size_t at = entry_bytes * std::size_t{chunk};
    entries_[chunk] = {number_at<std::uint64_t>(index, at), number_at<std::uint32_t>(index, at + 8),
                       number_at<std::uint32_t>(index, at + 12)};
  }
  // The chunks must fill the place between head and index, without gaps and without sharing bytes.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [this](std::uint32_t chunk) {
    return std::pair(entries_[chunk].offset, entries_[chunk].bytes);
  });
  std::uint64_t end = head_end;
  for (const std::uint32_t chunk : order) {
    const Entry& entry = entries_[chunk];
    if (entry.offset > index_begin || entry.bytes > index_begin - entry.offset)
      throw FormatError(chunk_name(chunk) + " ends beyond offset " + std::to_string(index_begin) +
                        ", where the index begins");
    if (entry.offset != end) {
      throw FormatError(chunk_name(chunk) + " begins at offset " + std::to_string(entry.offset) +
                        (entry.offset < end ? ", within what stands before it, which ends at "
                                            : ", not where what stands before it ends, at ") +
                        std::to_string(end));
    }
    end += entry.bytes;
  }
  if (end != index_begin) {
    throw FormatError("its chunks end at offset " + std::to_string(end) + ", and its index begins at " +
                      std::to_string(index_begin));
  }
}

void ChunkStore::read(std::uint32_t chunk, std::span<std::byte> memory) const {
  if (chunk >= entries_.size() || memory.size() != entries_[chunk].bytes) {
    throw std::invalid_argument(path_.string() + ": " + chunk_name(chunk) +
                                " does not exist or has other bytes than the memory for it");
  }
  if (read_some(entries_[chunk].offset, memory) != memory.size())
    throw FormatError(path_.string() + ": " + chunk_name(chunk) + " was cut off after the file was opened");
  if (crc32(memory) != entries_[chunk].checksum)
    throw FormatError(path_.string() + ": " + chunk_name(chunk) + " at offset " +
                      std::to_string(entries_[chunk].offset) + " is damaged: its checksum is not right");
}

void ChunkStore::forget_pages() const {
  ::posix_fadvise(file_, 0, 0, POSIX_FADV_DONTNEED);
}

}  // namespace vismat
