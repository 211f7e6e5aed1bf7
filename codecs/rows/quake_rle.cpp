#include "codecs/rows/quake_rle.h"

namespace vismat {

void QuakeRows::encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) const {
  std::size_t place = 0;  // in the bitmap's row
  const auto skip_to = [&](std::size_t next) {
    while (place < next) {
      const std::size_t run = std::min<std::size_t>(255, next - place);
      out.push_back(std::byte{0});
      out.push_back(static_cast<std::byte>(run));
      place += run;
    }
  };
  for (std::size_t i = 0; i < ids.size(); ++place) {
    skip_to(ids[i] / 8);
    unsigned byte = 0;
    for (; i < ids.size() && ids[i] / 8 == place; ++i) byte |= 1u << (ids[i] % 8);
    out.push_back(static_cast<std::byte>(byte));
  }
  skip_to(row_bytes_of(columns));
}

}  // namespace vismat
