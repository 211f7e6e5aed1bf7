#include "codecs/vmat/parts.h"

namespace vismat {

Parts::Parts(const Encoded& encoded)
    : payload_(encoded.payload),
      in_pieces_(!encoded.index.empty()),
      shared_(encoded.shared.begin(), encoded.shared.end()),
      bands_(encoded.bands) {
  if (!in_pieces_) return;
  index_ = PartIndex(encoded.index, payload_.size(), touch());
  index_.check_whole();
}

Parts::Parts(std::span<const std::byte> payload, std::span<const std::byte> index,
             std::vector<std::span<const std::byte>> shared, std::vector<std::uint32_t> bands,
             const CheckedBytes& file)
    : file_(&file),
      payload_(payload),
      in_pieces_(!index.empty()),
      shared_(std::move(shared)),
      bands_(std::move(bands)) {
  if (in_pieces_) index_ = PartIndex(index, payload_.size(), touch());
}

void Parts::expect_no_sections() const {
  if (!shared_.empty() || !bands_.empty())
    throw FormatError("shared sections or bands, of which this codec has none");
}

void Parts::expect(std::uint64_t parts) const {
  if (!in_pieces_ || count() != parts) {
    throw FormatError("the index tells of " + std::to_string(in_pieces_ ? count() : 0) +
                      " parts; there must be " + std::to_string(parts));
  }
}

VisibilityMatrix decode(const Codec& codec, const Encoded& encoded, Shape shape, const Side& side,
                        std::uint64_t most) {
  return codec.decode(Parts(encoded), shape, side, most);
}

}  // namespace vismat
