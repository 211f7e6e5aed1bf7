#include "visibility/levels/level_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "visibility/levels/doom_wad.h"
#include "visibility/levels/pk3.h"
#include "visibility/levels/quake3_bsp.h"
#include "visibility/levels/shader_script.h"

namespace vismat {
namespace {

enum class Kind { quake, doom, zip };

constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 30;  // of a file that is read whole

Kind kind_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw std::runtime_error(path.string() + ": cannot open this level");
  std::array<char, 4> magic{};
  file.read(magic.data(), magic.size());
  const std::string_view first(magic.data(), magic.size());
  if (first == "IBSP") return Kind::quake;
  if (first == "IWAD" || first == "PWAD") return Kind::doom;
  if (first.substr(0, 2) == "PK") return Kind::zip;
  throw FormatError(path.string() +
                    ": begins neither as a Quake-3 level (IBSP) nor as a .wad (IWAD, PWAD) or .pk3 (PK)");
}

std::vector<std::byte> read_whole(const std::filesystem::path& path) {
  if (const auto size = std::filesystem::file_size(path); size > most_file_bytes) {
    throw std::runtime_error(path.string() + ": has " + std::to_string(size) +
                             " bytes; a level file has at most " + std::to_string(most_file_bytes));
  }
  return read_file(path);
}

Level level_of_pk3(const Pk3& pk3, const std::string& map) {
  const std::vector<std::byte> level = pk3.read(map);
  std::set<std::string> see_through_shaders;
  std::uint64_t bytes = 0;
  for (const std::string& name : pk3.scripts()) {
    const std::vector<std::byte> script = pk3.read(name);
    if ((bytes += script.size()) > Pk3::most_member_bytes) {
      throw FormatError("its shader scripts unpack to more than " + std::to_string(Pk3::most_member_bytes) +
                        " bytes");
    }
    add_see_through_shaders({reinterpret_cast<const char*>(script.data()), script.size()},
                            see_through_shaders);
  }
  return parse_quake3_bsp(level, see_through_shaders);
}

// "FILE.pk3:maps/NAME.bsp" into its two halves; the second is empty where there is none.
std::pair<std::filesystem::path, std::string> split_place(const std::string& where) {
  std::string lower = where;
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  const std::size_t colon = std::min(lower.find(".pk3:"), lower.find(".wad:"));
  if (colon == std::string::npos) return {where, ""};
  return {where.substr(0, colon + 4), where.substr(colon + 5)};
}

}  // namespace

std::vector<LevelListing> list_levels(const std::filesystem::path& file) {
  std::vector<LevelListing> levels;
  const auto place = [&](const std::string& map) { return file.string() + ":" + map; };
  switch (kind_of(file)) {
    case Kind::quake:
      levels.push_back({file.string(), std::filesystem::file_size(file)});
      break;
    case Kind::zip:
      for (const Pk3::Map& map : Pk3(file).maps()) levels.push_back({place(map.name), map.bytes});
      break;
    case Kind::doom:
      try {
        for (const WadMap& map : doom_maps(read_whole(file))) levels.push_back({place(map.name), map.bytes});
      } catch (const FormatError& error) {
        throw FormatError(file.string() + ": " + error.what());
      }
  }
  return levels;
}

Level read_level(const std::string& where) {
  const auto [file, map] = split_place(where);
  const Kind kind = kind_of(file);
  if (kind != Kind::quake && map.empty()) {
    const auto levels = list_levels(file);
    throw FormatError(file.string() + ": holds " + std::to_string(levels.size()) + " levels" +
                      (levels.empty() ? "" : "; name one, such as " + levels.front().where));
  }
  try {
    Level level = kind == Kind::zip    ? level_of_pk3(Pk3(file), map)
                  : kind == Kind::doom ? parse_doom_map(read_whole(file), map)
                                       : parse_quake3_bsp(read_whole(file));
    level.name = file.filename().string() + (map.empty() ? "" : ":" + map);
    return level;
  } catch (const FormatError& error) {
    throw FormatError(where + ": " + error.what());
  }
}

}  // namespace vismat
