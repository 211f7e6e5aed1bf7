// A payload cut into parts, from memory or from a mapped file that is checked as it is read. Decoders read from it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "codecs/codec.h"
#include "codecs/vmat/checked_bytes.h"
#include "codecs/vmat/part_index.h"

namespace vismat {

/// Borrows all bytes. What it returns from a file has passed its checksum. Thread-safe.
class Parts {
  struct Touch {
    const CheckedBytes* file;
    std::span<const std::byte> operator()(std::span<const std::byte> bytes) const {
      return file == nullptr ? bytes : file->checked(bytes);
    }
  };
  Touch touch() const { return {file_}; }
  std::span<const std::byte> checked(std::span<const std::byte> bytes) const { return touch()(bytes); }

 public:
  Parts() = default;
  /// The parts of an encoder's result. Throws FormatError if the index is not as the writer makes it. O(parts).
  explicit Parts(const Encoded& encoded);
  /// The same from a file; reads only the head of the index. An empty index means a payload in one piece.
  Parts(std::span<const std::byte> payload, std::span<const std::byte> index,
        std::vector<std::span<const std::byte>> shared, std::vector<std::uint32_t> bands,
        const CheckedBytes& file);

  std::uint64_t count() const { return index_.parts(); }
  std::uint64_t payload_bytes() const { return payload_.size(); }
  /// All of a payload that is one piece, O(its blocks). Throws FormatError if there is an index.
  std::span<const std::byte> whole() const {
    if (in_pieces_) throw FormatError("an index of parts; this codec's payload is one piece");
    expect_no_sections();
    return checked(payload_);
  }
  /// The bytes before the first part.
  std::span<const std::byte> model() const {
    return checked(payload_.first(in_pieces_ ? index_.model_bytes(touch()) : payload_.size()));
  }
  /// Part i < count(). Throws FormatError if the bytes are damaged.
  std::span<const std::byte> part(std::uint64_t i) const {
    const auto [begin, end] = index_.part(i, touch());
    return checked(payload_.subspan(begin, end - begin));
  }
  std::uint64_t part_bytes(std::uint64_t i) const {
    const auto [begin, end] = index_.part(i, touch());
    return end - begin;
  }
  std::size_t shared_count() const { return shared_.size(); }
  /// Shared section i of the model. Throws FormatError if there is none.
  std::span<const std::byte> shared(std::size_t i) const {
    if (i >= shared_.size()) throw FormatError("shared section " + std::to_string(i) + " is missing");
    return checked(shared_[i]);
  }
  /// The first rows of the bands; empty if there are none.
  std::span<const std::uint32_t> bands() const { return bands_; }
  /// Throws FormatError if there are shared sections or bands; for codecs that have none.
  void expect_no_sections() const;
  /// Throws FormatError unless there are exactly that many parts.
  void expect(std::uint64_t parts) const;

 private:
  const CheckedBytes* file_ = nullptr;
  std::span<const std::byte> payload_;
  bool in_pieces_ = false;
  PartIndex index_;
  std::vector<std::span<const std::byte>> shared_;
  std::vector<std::uint32_t> bands_;
};

/// Decodes what `codec` made.
VisibilityMatrix decode(const Codec& codec, const Encoded& encoded, Shape shape, const Side& side = {},
                        std::uint64_t most = ~std::uint64_t{0});

}  // namespace vismat
