#include "codecs/row_reader.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "codecs/container.h"
#include "codecs/row_codec.h"
#include "codecs/sections.h"

namespace vismat {
namespace {

/// A file's bytes for as long as this lives.
class Mapping {
 public:
  Mapping() = default;
  explicit Mapping(const std::filesystem::path& path) {
    const auto fail = [&] {
      throw std::runtime_error(path.string() + ": " + std::system_category().message(errno));
    };
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) fail();
    struct stat status {};
    const bool known = ::fstat(file, &status) == 0;
    void* start = nullptr;
    if (known && status.st_size > 0)
      start = ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, file, 0);
    const int error = errno;
    ::close(file);
    errno = error;
    if (!known || start == MAP_FAILED) fail();
    if (start != nullptr)
      bytes_ = {static_cast<const std::byte*>(start), static_cast<std::size_t>(status.st_size)};
  }
  ~Mapping() {
    if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

const Codec& codec_named(const std::string& name, std::span<const Codec> codecs) {
  const auto found =
      std::find_if(codecs.begin(), codecs.end(), [&](const Codec& c) { return c.name == name; });
  if (found == codecs.end()) throw FormatError("codec '" + name + "' is unknown here");
  if (found->open_rows == nullptr)
    throw FormatError("codec '" + name + "' gives no single rows; decode the file");
  return *found;
}

}  // namespace

struct RowReader::Open {
  Mapping mapping;
  std::string name;  // of the file, for messages; empty for bytes
  ContainerHead head;
  const Codec& codec;
  std::unique_ptr<std::atomic<std::uint64_t>[]> checked;  // a bit for each block: its checksum was right
  RowIndex index;
  std::unique_ptr<const RowDecoder> decoder;

  Open(const std::filesystem::path& path, std::span<const Codec> codecs)
      : mapping(path), name(path), head(mapping.bytes()), codec(codec_named(head.codec, codecs)) {
    begin();
  }
  Open(std::span<const std::byte> bytes, std::span<const Codec> codecs)
      : head(bytes), codec(codec_named(head.codec, codecs)) {
    begin();
  }
  // The same bytes, checked. Bits are set after the check, and blocks never change: a thread that does not see a bit yet
  // checks again, no more.
  std::span<const std::byte> check(std::span<const std::byte> bytes) const {
    if (bytes.empty()) return bytes;
    const auto begin = static_cast<std::uint64_t>(bytes.data() - head.body().data());
    for (std::uint64_t b = begin / ContainerHead::block_bytes;
         b <= (begin + bytes.size() - 1) / ContainerHead::block_bytes; ++b) {
      const std::uint64_t bit = std::uint64_t{1} << (b % 64);
      if (checked[b / 64].load(std::memory_order_relaxed) & bit) [[likely]]
        continue;
      head.check_block(b);
      checked[b / 64].fetch_or(bit, std::memory_order_relaxed);
    }
    return bytes;
  }
  auto in_index() const {
    return [this](std::uint64_t offset, std::uint64_t size) {
      check(head.section(ContainerHead::index).subspan(offset, size));
    };
  }
  void begin() {
    checked = std::make_unique<std::atomic<std::uint64_t>[]>((head.blocks() + 63) / 64);
    const auto payload = head.section(ContainerHead::payload);
    index =
        RowIndex(head.section(ContainerHead::index), head.shape.rows, codec.rows_per_part, payload.size());
    const std::uint64_t model = index.parts() == 0 ? payload.size() : index.model_bytes(in_index());
    decoder = codec.open_rows(check(payload.first(model)), head.shape);
  }

  std::span<const std::byte> part(std::uint32_t row) const {
    if (row >= head.shape.rows) [[unlikely]]
      throw std::out_of_range("row " + std::to_string(row) + " of " + std::to_string(head.shape.rows));
    const auto place = index.part(row / codec.rows_per_part, in_index());
    return check(head.section(ContainerHead::payload).subspan(place.begin, place.end - place.begin));
  }
  template <typename Sink>
  void decode(std::uint32_t row, Sink sink) const {
    naming([&] { decoder->decode(row, part(row), sink); }, &row);
    sink.finish();
  }
  template <typename Work>
  auto naming(const Work& work, const std::uint32_t* row = nullptr) const {
    try {
      return work();
    } catch (const FormatError& error) {
      throw FormatError((name.empty() ? "" : name + ": ") +
                        (row ? "row " + std::to_string(*row) + ": " : "") + error.what());
    }
  }
};

RowReader::RowReader(const std::filesystem::path& file, std::span<const Codec> codecs) {
  try {
    open_ = std::make_unique<Open>(file, codecs);
  } catch (const FormatError& error) {
    throw FormatError(file.string() + ": " + error.what());
  }
}
RowReader::RowReader(std::span<const std::byte> bytes, std::span<const Codec> codecs)
    : open_(std::make_unique<Open>(bytes, codecs)) {}
RowReader::~RowReader() = default;
RowReader::RowReader(RowReader&&) noexcept = default;
RowReader& RowReader::operator=(RowReader&&) noexcept = default;

Shape RowReader::shape() const {
  return open_->head.shape;
}
std::uint64_t RowReader::ones() const {
  return open_->head.ones;
}
std::string_view RowReader::codec() const {
  return open_->codec.name;
}
std::string RowReader::facts() const {
  return open_->naming([&] {
    const auto bytes = open_->check(open_->head.section(ContainerHead::facts));
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  });
}

std::span<const std::uint32_t> RowReader::ids(std::uint32_t row, RowBuffer<std::uint32_t>& buffer) const {
  open_->decode(row, IdSink(buffer, shape().columns, ones()));
  return buffer.content();
}
std::span<const Run> RowReader::runs(std::uint32_t row, RowBuffer<Run>& buffer) const {
  open_->decode(row, RunSink(buffer, shape().columns, ones()));
  return buffer.content();
}
void RowReader::bits(std::uint32_t row, std::span<std::uint64_t> words) const {
  const std::size_t need = (std::size_t{shape().columns} + 63) / 64;
  if (words.size() < need)
    throw std::length_error(std::to_string(words.size()) + " words for a row of " + std::to_string(need));
  std::fill_n(words.begin(), need, 0);
  open_->decode(row, BitSink(words, shape().columns, ones()));
}
std::uint64_t RowReader::row_bytes(std::uint32_t row) const {
  return open_->naming([&] { return open_->part(row).size(); });
}

std::optional<Permutation> RowReader::row_order() const {
  return open_->naming([&] {
    return order_from_bytes(open_->check(open_->head.section(ContainerHead::row_order)), shape().rows);
  });
}
std::optional<Permutation> RowReader::column_order() const {
  return open_->naming([&] {
    return order_from_bytes(open_->check(open_->head.section(ContainerHead::column_order)), shape().columns);
  });
}
std::optional<Partition> RowReader::row_groups() const {
  return open_->naming([&] {
    return groups_from_bytes(open_->check(open_->head.section(ContainerHead::row_groups)), shape().rows);
  });
}
std::optional<Partition> RowReader::column_groups() const {
  return open_->naming([&] {
    return groups_from_bytes(open_->check(open_->head.section(ContainerHead::column_groups)), shape().columns);
  });
}

std::vector<Boundary> RowReader::boundaries() const {
  return open_->naming([&] {
    return boundaries_from_bytes(open_->check(open_->head.section(ContainerHead::boundaries)), shape().rows);
  });
}

}  // namespace vismat
