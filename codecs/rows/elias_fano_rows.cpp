#include "codecs/rows/elias_fano_rows.h"

#include "codecs/entropy/bit_stream.h"

namespace vismat {

void EliasFanoRows::encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) const {
  if (ids.empty()) return;
  const unsigned low_bits = elias_fano_low_bits(ids.size(), columns);
  put_varint(out, ids.size());
  BitWriter low(out);
  for (const std::uint32_t id : ids) low.put(lowest_bits(id, low_bits), low_bits);
  low.flush();
  const std::size_t high = out.size();
  out.resize(high + ((ids.back() >> low_bits) + ids.size() - 1) / 8 + 1, std::byte{0});
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::size_t place = (ids[i] >> low_bits) + i;
    out[high + place / 8] |= std::byte{1} << (place % 8);
  }
}

}  // namespace vismat
