// Any bytes as a .pk3: its levels are listed, unpacked and read, or raise FormatError.
#include <cstdint>
#include <cstdlib>

#include "matrix/byte_reader.h"
#include "visibility/levels/pk3.h"
#include "visibility/levels/quake3_bsp.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  try {
    const Pk3 pk3(std::as_bytes(std::span(data, size)));
    for (const Pk3::Map& map : pk3.maps()) {
      const auto member = pk3.read(map.name);
      if (member.size() > Pk3::most_member_bytes) std::abort();
      parse_quake3_bsp(member);
    }
  } catch (const FormatError&) {
  }
  return 0;
}
