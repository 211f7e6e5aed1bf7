// The `.vmat` file: one compressed visibility matrix. docs/vmat.md gives the layout. read_container reads all of a
// file; row_reader.h reads single rows of a file that is mapped.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "codecs/codec.h"
#include "codecs/vmat/checked_bytes.h"
#include "codecs/vmat/vmat_format.h"

namespace vismat {

/// The checksums of the boxes of rows and columns with which a payload was coded.
struct BoxSums {
  std::uint32_t rows = 0, columns = 0;
  bool operator==(const BoxSums&) const = default;
};
BoxSums box_sums(const Side& side);

struct Container {
  Shape shape;
  std::uint64_t ones = 0;
  std::string codec;
  Encoded encoded;
  SourceMap source;
  std::optional<BoxSums> boxes;  // for codecs that need boxes; the reader must have the boxes themselves
  std::string facts;             // the facts of the source file, one `key: value` on each line
  bool operator==(const Container&) const = default;
};

/// The same container gives the same bytes. Throws std::invalid_argument if its parts do not fit one another.
std::vector<std::byte> write_container(const Container& container);
/// Throws FormatError on bytes that write_container cannot have made: wrong magic, another version, sizes that do not
/// add up to the file's, a wrong checksum, a tree or an order that is invalid. Memory grows only as the file's bytes
/// back it.
Container read_container(std::span<const std::byte> bytes);

/// Encodes the matrix over the tree of `source` that the codec needs and with the boxes of `boxes`, whose tree is not
/// used. The container keeps `source`, which says where rows went if the options let them move. Throws what the codec
/// throws.
Container compress(const VisibilityMatrix& matrix, const Codec& codec, SourceMap source = {},
                   const EncodeOptions& options = {}, const Side& boxes = {});
/// The matrix as it is in the file. `codec` must be the one that the container names, and `boxes` must have the boxes
/// with which it was coded, if it needs any. Throws FormatError if they differ, or if the payload does not decode to
/// the container's shape and number of ones.
VisibilityMatrix decompress(const Container& container, const Codec& codec, const Side& boxes = {});
/// Throws FormatError if a codec that needs boxes lacks those of a row or column, or if they differ from those it was
/// coded with.
void check_boxes(const Codec& codec, Shape shape, const std::optional<BoxSums>& coded_under,
                 const Side& boxes);

/// The shape, the ones and the codec's name, which heads of versions 3 and 4 have in common. Throws FormatError.
std::tuple<Shape, std::uint64_t, std::string> read_head_fields(ByteReader& head);

/// The head of a file and where its sections begin: what a reader checks before anything else.
class ContainerHead {
 public:
  /// Checks the magic, the version, the head's checksum, that the sections fill the file exactly, and the checksum over
  /// the blocks' checksums. O(blocks); reads nothing of the body. Throws FormatError.
  explicit ContainerHead(std::span<const std::byte> file);

  Shape shape;
  std::uint64_t ones = 0;
  std::string codec;
  /// Borrowed from the file; empty if absent. The bytes are unchecked until CheckedBytes has checked them.
  std::span<const std::byte> section(vmat::Section which) const;
  std::span<const std::byte> body() const { return body_; }
  std::span<const std::byte> sums() const { return sums_; }

 private:
  std::span<const std::byte> sums_, body_;
  std::vector<std::pair<vmat::Section, std::span<const std::byte>>> sections_;
};

/// The content of the sections of a checked file. All throw FormatError.
SourceMap read_source_map(const ContainerHead& head, const CheckedBytes& body);
std::string read_facts(const ContainerHead& head, const CheckedBytes& body);
std::optional<BoxSums> read_box_sums(const ContainerHead& head, const CheckedBytes& body);
std::vector<std::uint32_t> read_bands(const ContainerHead& head, const CheckedBytes& body);
std::vector<std::span<const std::byte>> shared_sections(const ContainerHead& head);  // unchecked

/// Corrects every checksum in bytes whose head has sizes that fit the file; other bytes stay as they are. The writer's
/// last step, which fuzzers need too.
void seal_container(std::span<std::byte> file);

}  // namespace vismat
