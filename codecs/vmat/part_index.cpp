#include "codecs/vmat/part_index.h"

#include <cassert>
#include <string>

#include "codecs/entropy/elias_fano.h"

namespace vismat {

PartIndex::Layout::Layout(std::uint64_t parts, std::uint64_t payload_bytes)
    : low_bits(elias_fano_low_bits(parts + 1, payload_bytes)),
      samples(parts / sample_step),
      high_bits(parts + 1 + (payload_bytes >> low_bits)),
      low_bytes(((parts + 1) * low_bits + 7) / 8) {
  sample_bytes = high_bits >> 32 == 0 ? 4 : 8;
}

std::vector<std::byte> part_index_bytes(std::span<const std::uint64_t> starts, std::uint64_t payload_bytes,
                                        IndexForm form) {
  const std::uint64_t parts = starts.size();
  std::vector<std::byte> out;
  put_varint(out, parts);
  bool equal = parts == 0 || payload_bytes % parts == 0;
  for (std::uint64_t i = 0; equal && i < parts; ++i) equal = starts[i] == i * (payload_bytes / parts);
  if (equal) return out;
  if (form == IndexForm::plain && payload_bytes >> 32 == 0) {
    out.assign(1 + 4 * (parts + 1), std::byte{0});
    for (std::uint64_t i = 0; i <= parts; ++i) {
      const auto place = static_cast<std::uint32_t>(i < parts ? starts[i] : payload_bytes);
      std::memcpy(out.data() + 1 + 4 * i, &place, sizeof place);
    }
    return out;
  }
  const PartIndex::Layout layout(parts, payload_bytes);
  const std::size_t samples = out.size(), high = samples + layout.samples * layout.sample_bytes,
                    low = high + (layout.high_bits + 7) / 8;
  out.resize(low + layout.low_bytes);
  const auto set = [&](std::size_t begin, std::uint64_t bit) {
    out[begin + bit / 8] |= std::byte{1} << (bit % 8);
  };
  for (std::uint64_t i = 0; i <= parts; ++i) {
    const std::uint64_t start = i < parts ? starts[i] : payload_bytes;
    assert(start <= payload_bytes && (i == 0 || start >= starts[i - 1]));
    const std::uint64_t place = (start >> layout.low_bits) + i;
    set(high, place);
    if (i > 0 && i % PartIndex::sample_step == 0)
      std::memcpy(out.data() + samples + (i / PartIndex::sample_step - 1) * layout.sample_bytes, &place,
                  layout.sample_bytes);
    for (unsigned b = 0; b < layout.low_bits; ++b) {
      if ((start >> b & 1) != 0) set(low, i * layout.low_bits + b);
    }
  }
  return out;
}

void PartIndex::open(std::span<const std::byte> head, std::span<const std::byte> index) {
  ByteReader in(head, "index of the parts");
  index_ = index;
  parts_ = in.varint();
  if (in.offset() == index.size()) {
    if (parts_ > 0 && payload_bytes_ % parts_ != 0)
      in.fail(std::to_string(payload_bytes_) + " bytes of payload are not " + std::to_string(parts_) +
              " equal parts");
    equal_bytes_ = parts_ == 0 ? 0 : payload_bytes_ / parts_;
    return;
  }
  if (parts_ == 0) {
    plain_ = index.subspan(1);
    parts_ = plain_.size() / 4 - std::min<std::uint64_t>(1, plain_.size() / 4);
    if (parts_ == 0 || plain_.size() % 4 != 0)
      in.fail(std::to_string(plain_.size()) + " bytes of plain places; they have 4 bytes each, from 2 on");
    equal_bytes_.reset();
    return;
  }
  // Each part takes a bit or more, which bounds what the layout multiplies.
  if (parts_ > 8 * index.size())
    in.fail(std::to_string(parts_) + " parts in " + std::to_string(index.size()) + " bytes");
  const Layout layout(parts_, payload_bytes_);
  if (layout.bytes() != index.size() - in.offset()) {
    in.fail(std::to_string(index.size() - in.offset()) + " bytes; " + std::to_string(parts_) + " parts of " +
            std::to_string(payload_bytes_) + " bytes take " + std::to_string(layout.bytes()));
  }
  equal_bytes_.reset();
  low_bits_ = layout.low_bits;
  sample_bytes_ = layout.sample_bytes;
  samples_ = index.subspan(in.offset(), layout.samples * layout.sample_bytes);
  high_ = index.subspan(in.offset() + samples_.size(), (layout.high_bits + 7) / 8);
  low_ = index.last(layout.low_bytes);
}

void PartIndex::check_whole() const {
  if (equal_bytes_) return;
  constexpr auto as_is = [](std::span<const std::byte> bytes) { return bytes; };
  std::vector<std::uint64_t> starts;
  starts.reserve(parts_ + 1);
  Words words{high_, 0};
  std::uint64_t bits = plain_.empty() ? words.first(as_is) : 0;
  const auto next_start = [&](std::uint64_t i) -> std::uint64_t {
    if (!plain_.empty()) return number_at<std::uint32_t>(plain_, 4 * i);
    while (bits == 0) bits = words.next(as_is);
    const std::uint64_t place = words.place(bits);
    bits &= bits - 1;
    return number(place, i, as_is);
  };
  for (std::uint64_t i = 0; i <= parts_; ++i) {
    starts.push_back(next_start(i));
    if (starts.back() > payload_bytes_ || (i > 0 && starts[i] < starts[i - 1])) refuse();
  }
  if (starts.back() != payload_bytes_) refuse();
  starts.pop_back();
  const auto form = plain_.empty() ? IndexForm::small : IndexForm::plain;
  if (!std::ranges::equal(part_index_bytes(starts, payload_bytes_, form), index_)) refuse();
}

}  // namespace vismat
