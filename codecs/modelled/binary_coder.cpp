#include "codecs/modelled/binary_coder.h"

namespace vismat {

void BinaryWriter::finish() {
  for (unsigned keep = 0; keep <= 64; keep += 8) {  // the shortest value in [low, low + range)
    const std::uint64_t mask = keep == 64 ? 0 : ~std::uint64_t{0} >> keep, above = (0 - low_) & mask;
    if (above >= range_) continue;
    narrow(above, 1);
    break;
  }
  for (unsigned shift = 64; shift > 0; shift -= 8)
    out_.push_back(static_cast<std::byte>(low_ >> (shift - 8)));
  drop_last_zeros(out_, begin_);
}

// What remains of the code value is the distance of the writer's last value from its low. So the value that it chose is
// known without low's higher bytes.
void BinaryReader::finish() const {
  std::uint64_t value = 0;
  for (std::size_t i = next_ - 8; i < next_; ++i)
    value = value << 8 | (i < bytes_.size() ? std::to_integer<std::uint64_t>(bytes_[i]) : 0);
  const std::uint64_t low = value - code_;
  std::uint64_t above = 0;
  for (unsigned keep = 0; keep <= 64; keep += 8) {
    above = (0 - low) & (keep == 64 ? 0 : ~std::uint64_t{0} >> keep);
    if (above < range_) break;
  }
  if (above != code_ || bytes_.size() > next_ || (!bytes_.empty() && bytes_.back() == std::byte{0}))
    throw FormatError("range coder: a writer ends with other bytes");
}

void BinaryReader::refuse() {
  throw FormatError("range coder: no value stands here");
}

}  // namespace vismat
