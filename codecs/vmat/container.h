// `.vmat`: one compressed visibility matrix in a file. docs/vmat.md gives the layout. read_container takes in all of it;
// row_reader.h reads single rows of a file that stays where it is.
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

/// Checksums of the boxes of rows and of columns that a payload was coded under.
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
  std::optional<BoxSums> boxes;  // of a codec that needs boxes; the boxes themselves the reader must have
  std::string facts;             // what the source file said of the matrix, one `key: value` a line
  bool operator==(const Container&) const = default;
};

/// Same container, same bytes. Throws std::invalid_argument where a part of it does not fit the others.
std::vector<std::byte> write_container(const Container& container);
/// Throws FormatError on bytes that write_container cannot have made: wrong magic, another version, sizes that do not add
/// up to the file's, a checksum that differs, a tree or an order that is none. Takes memory as the file's bytes back it.
Container read_container(std::span<const std::byte> bytes);

/// Encodes the matrix as it stands, over that tree of `source` which the codec needs and under the boxes of `side`, whose tree
/// is not looked at; the container keeps `source`. Throws what the codec throws.
Container compress(const VisibilityMatrix& matrix, const Codec& codec, SourceMap source = {},
                   const EncodeOptions& options = {}, const Side& boxes = {});
/// The matrix as it stands in the file. `codec` must be the one that the container names; the boxes of `boxes` those that it was
/// coded under, if it was under any. FormatError where they are not, or where the payload does not decode to the shape and
/// number of ones that the container states.
VisibilityMatrix decompress(const Container& container, const Codec& codec, const Side& boxes = {});
/// Throws FormatError unless a codec that needs boxes has these of each row and column, and they are those coded under.
void check_boxes(const Codec& codec, Shape shape, const std::optional<BoxSums>& coded_under,
                 const Side& boxes);

/// Shape, ones and the codec's name, which stand so in the heads of versions 3 and 4. Throws FormatError.
std::tuple<Shape, std::uint64_t, std::string> read_head_fields(ByteReader& head);

/// The head of a file and where its sections lie; what a reader checks before it touches anything else.
class ContainerHead {
 public:
  /// Checks magic, version, the head's checksum, that the sections fill the file exactly, and the checksum over the blocks'
  /// checksums. O(blocks); reads nothing of the body. Throws FormatError.
  explicit ContainerHead(std::span<const std::byte> file);

  Shape shape;
  std::uint64_t ones = 0;
  std::string codec;
  /// Borrowed from the file, empty where there is none. Its bytes are unchecked until CheckedBytes has gone over them.
  std::span<const std::byte> section(vmat::Section which) const;
  std::span<const std::byte> body() const { return body_; }
  std::span<const std::byte> sums() const { return sums_; }

 private:
  std::span<const std::byte> sums_, body_;
  std::vector<std::pair<vmat::Section, std::span<const std::byte>>> sections_;
};

/// What the sections of a checked file hold. All throw FormatError.
SourceMap read_source_map(const ContainerHead& head, const CheckedBytes& body);
std::string read_facts(const ContainerHead& head, const CheckedBytes& body);
std::optional<BoxSums> read_box_sums(const ContainerHead& head, const CheckedBytes& body);
std::vector<std::uint32_t> read_bands(const ContainerHead& head, const CheckedBytes& body);
std::vector<std::span<const std::byte>> shared_sections(const ContainerHead& head);  // unchecked

/// Makes every checksum right in bytes whose head tells sizes that fit the file; other bytes stay as they are. The
/// writer's last step, and what a fuzzer needs.
void seal_container(std::span<std::byte> file);

}  // namespace vismat
