#include "codecs/vmat/row_reader.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "codecs/vmat/container.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/sections.h"

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

Codec codec_of(const std::string& name, std::span<const Codec> codecs) {
  const Codec& codec = codec_of_file(name, codecs);
  if (codec.open == nullptr) throw FormatError("codec '" + name + "' gives no single rows; decode the file");
  return codec;
}

}  // namespace

struct RowReader::Open {
  Mapping mapping;
  std::string name;  // of the file, for messages; empty for bytes
  ContainerHead head;
  CheckedBytes body;
  Codec codec;
  std::optional<ObjectTree> tree;  // that the codec needs
  std::unique_ptr<const RowSource> rows;
  bool writes_all_words = false;

  Open(const std::filesystem::path& path, std::span<const Codec> codecs, const Side& boxes)
      : mapping(path),
        name(path),
        head(mapping.bytes()),
        body(head.body(), head.sums()),
        codec(codec_of(head.codec, codecs)) {
    open(boxes);
  }
  Open(std::span<const std::byte> bytes, std::span<const Codec> codecs, const Side& boxes)
      : head(bytes), body(head.body(), head.sums()), codec(codec_of(head.codec, codecs)) {
    open(boxes);
  }
  void open(const Side& boxes) {
    if (codec.needs.tree != TreeOver::nothing) {
      const auto which = codec.needs.tree == TreeOver::rows ? vmat::Section::row_tree : vmat::Section::tree;
      if (const auto bytes = body.checked(head.section(which)); !bytes.empty())
        tree = tree_from_bytes(bytes).first;
    }
    check_boxes(codec, head.shape, read_box_sums(head, body), boxes);
    const Side side{tree ? &*tree : nullptr, boxes.row_boxes, boxes.column_boxes};
    Parts parts(head.section(vmat::Section::payload), head.section(vmat::Section::index),
                shared_sections(head), read_bands(head, body), body);
    rows = codec.open(std::move(parts), head.shape, side);
    writes_all_words = rows->writes_all_words();
  }

  void check(std::uint32_t row) const {
    if (row >= head.shape.rows) [[unlikely]]
      refuse(row);
  }
  [[noreturn, gnu::noinline]] void refuse(std::uint32_t row) const {
    throw std::out_of_range("row " + std::to_string(row) + " of " + std::to_string(head.shape.rows));
  }
  template <typename Sink>
  void decode(std::uint32_t row, RowScratch& scratch, Sink sink) const {
    check(row);
    naming([&] { rows->read(row, scratch, sink); }, &row);
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

RowReader::RowReader(const std::filesystem::path& file, std::span<const Codec> codecs, const Side& boxes) {
  try {
    open_ = std::make_unique<Open>(file, codecs, boxes);
  } catch (const FormatError& error) {
    throw FormatError(file.string() + ": " + error.what());
  }
}
RowReader::RowReader(std::span<const std::byte> bytes, std::span<const Codec> codecs, const Side& boxes)
    : open_(std::make_unique<Open>(bytes, codecs, boxes)) {}
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
  return open_->naming([&] { return read_facts(open_->head, open_->body); });
}

std::span<const std::uint32_t> RowReader::ids(std::uint32_t row, RowBuffer<std::uint32_t>& buffer) const {
  open_->decode(row, buffer, IdSink(buffer, open_->head.shape.columns, open_->head.ones));
  return buffer.content();
}
std::span<const Run> RowReader::runs(std::uint32_t row, RowBuffer<Run>& buffer) const {
  open_->decode(row, buffer, RunSink(buffer, open_->head.shape.columns, open_->head.ones));
  return buffer.content();
}
void RowReader::bits(std::uint32_t row, std::span<std::uint64_t> words, RowScratch& scratch) const {
  const std::size_t need = (std::size_t{open_->head.shape.columns} + 63) / 64;
  if (words.size() < need)
    throw std::length_error(std::to_string(words.size()) + " words for a row of " + std::to_string(need));
  if (!open_->writes_all_words) std::fill_n(words.begin(), need, 0);
  open_->decode(row, scratch, BitSink(words, open_->head.shape.columns, open_->head.ones));
}
RowSource::Cost RowReader::cost(std::uint32_t row) const {
  open_->check(row);
  return open_->naming([&] { return open_->rows->cost(row); });
}

SourceMap RowReader::source() const {
  return open_->naming([&] { return read_source_map(open_->head, open_->body); });
}

}  // namespace vismat
