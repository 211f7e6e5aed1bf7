// Any bytes as a zip archive: its scripts are read, its levels and .wad files listed, unpacked and read, or raise
// FormatError.
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>

#include "matrix/base/byte_reader.h"
#include "visibility/levels/doom_wad.h"
#include "visibility/levels/pk3.h"
#include "visibility/levels/quake3_bsp.h"
#include "visibility/levels/shader_script.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  try {
    const Pk3 pk3(std::as_bytes(std::span(data, size)));
    std::set<std::string> see_through;
    for (const std::string& name : pk3.scripts()) {
      const auto script = pk3.read(name);
      add_see_through_shaders({reinterpret_cast<const char*>(script.data()), script.size()}, see_through);
    }
    for (const Pk3::Map& wad : pk3.wads()) {
      const auto member = pk3.read(wad.name);
      for (const WadMap& map : doom_maps(member)) parse_doom_map(member, map.name);
    }
    for (const Pk3::Map& map : pk3.maps()) {
      const auto member = pk3.read(map.name);
      if (member.size() > Pk3::most_member_bytes) std::abort();
      parse_quake3_bsp(member, see_through);
    }
  } catch (const FormatError&) {
  }
  return 0;
}
