#include "visibility/levels/level_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "visibility/levels/ascii.h"
#include "visibility/levels/doom_wad.h"
#include "visibility/levels/pk3.h"
#include "visibility/levels/quake3_bsp.h"
#include "visibility/levels/shader_script.h"

namespace vismat {
namespace {

enum class Kind { quake, doom, zip };

constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 30;  // of a file that is read whole

std::optional<Kind> kind_of_bytes(std::string_view first) {
  if (first.starts_with("IBSP")) return Kind::quake;
  if (first.starts_with("IWAD") || first.starts_with("PWAD")) return Kind::doom;
  if (first.starts_with("PK")) return Kind::zip;
  return {};
}
std::string first_bytes(std::ifstream& file) {
  std::string first(4, '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  return first;
}

Kind kind_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw std::runtime_error(path.string() + ": cannot open this level");
  if (const auto kind = kind_of_bytes(first_bytes(file))) return *kind;
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

std::set<std::string> see_through_shaders_of(const Pk3& archive, LevelNeeds needs) {
  std::set<std::string> shaders;
  std::uint64_t bytes = 0;
  for (const std::string& name : archive.scripts()) {
    try {
      const std::vector<std::byte> script = archive.read(name);
      if ((bytes += script.size()) > Pk3::most_member_bytes) {
        throw FormatError("its shader scripts unpack to more than " + std::to_string(Pk3::most_member_bytes) +
                          " bytes");
      }
      add_see_through_shaders({reinterpret_cast<const char*>(script.data()), script.size()}, shaders);
    } catch (const FormatError&) {
      if (needs.see_through) throw;
    }
  }
  return shaders;
}

VisibilityData visibility_data(LevelNeeds needs) {
  return needs.visibility ? VisibilityData::needed : VisibilityData::not_needed;
}

bool is_wad(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return kind_of_bytes(text) == Kind::doom;
}

// `map` is a member, or WAD:MAP.
Level level_of_archive(const Pk3& archive, const std::string& map, LevelNeeds needs) {
  if (!archive.has(map)) {
    for (std::size_t colon = map.find(':'); colon != std::string::npos; colon = map.find(':', colon + 1)) {
      if (!archive.has(map.substr(0, colon))) continue;
      const std::vector<std::byte> wad = archive.read(map.substr(0, colon));
      if (is_wad(wad)) return parse_doom_map(wad, map.substr(colon + 1));
    }
  }
  const std::vector<std::byte> level = archive.read(map);
  if (is_wad(level)) {
    const auto maps = doom_maps(level);
    throw FormatError("holds " + std::to_string(maps.size()) + " levels" +
                      (maps.empty() ? "" : "; name one, such as " + map + ":" + maps.front().name));
  }
  return parse_quake3_bsp(level, see_through_shaders_of(archive, needs), visibility_data(needs));
}

constexpr std::array<std::string_view, 4> archive_endings = {".pk3", ".pk4", ".zip", ".wad"};

// "FILE.pk3:maps/NAME.bsp" into its two halves; the second is empty where there is none. Folders may have colons in
// their names, so the file that exists decides; if none does, the ending.
std::pair<std::filesystem::path, std::string> split_place(const std::string& where) {
  std::error_code ignored;
  if (std::filesystem::exists(where, ignored)) return {where, ""};
  std::size_t file_end = std::string::npos;
  for (std::size_t colon = where.find(':'); colon != std::string::npos; colon = where.find(':', colon + 1)) {
    const std::string file = where.substr(0, colon);
    if (!std::filesystem::is_regular_file(file, ignored)) continue;
    std::ifstream stream(file, std::ios::binary);
    const bool holds_levels = kind_of_bytes(first_bytes(stream)).has_value();
    if (holds_levels || file_end == std::string::npos) file_end = colon;
    if (holds_levels) break;
  }
  if (file_end != std::string::npos) return {where.substr(0, file_end), where.substr(file_end + 1)};
  const std::string lower = ascii_lower(where);
  std::size_t colon = std::string::npos;
  for (const std::string_view ending : archive_endings) {
    colon = std::min(colon, lower.find(std::string(ending) + ":"));
  }
  if (colon == std::string::npos) return {where, ""};
  return {where.substr(0, colon + 4), where.substr(colon + 5)};
}

std::vector<LevelListing> levels_of_archive(const std::filesystem::path& file) {
  const Pk3 archive(file);
  std::vector<LevelListing> levels;
  const std::string place = file.string() + ":";
  for (const Pk3::Map& map : archive.maps()) levels.push_back({place + map.name, map.bytes});
  std::uint64_t unpacked = 0;
  for (const Pk3::Map& wad : archive.wads()) {
    std::vector<WadMap> maps;
    try {
      if ((unpacked += wad.bytes) <= most_file_bytes) maps = doom_maps(archive.read(wad.name));
    } catch (const FormatError&) {  // whoever names it learns why
    }
    for (const WadMap& map : maps) levels.push_back({place + wad.name + ":" + map.name, map.bytes});
    if (maps.empty()) levels.push_back({place + wad.name, wad.bytes});
  }
  return levels;
}

}  // namespace

std::vector<LevelListing> list_levels(const std::filesystem::path& file) {
  std::vector<LevelListing> levels;
  switch (kind_of(file)) {
    case Kind::quake:
      levels.push_back({file.string(), std::filesystem::file_size(file)});
      break;
    case Kind::zip:
      levels = levels_of_archive(file);
      break;
    case Kind::doom:
      try {
        for (const WadMap& map : doom_maps(read_whole(file))) {
          levels.push_back({file.string() + ":" + map.name, map.bytes});
        }
      } catch (const FormatError& error) {
        throw FormatError(file.string() + ": " + error.what());
      }
  }
  return levels;
}

bool names_level(const std::string& where) {
  const auto [file, map] = split_place(where);
  const std::string lower = ascii_lower(file.string());
  if (lower.ends_with(".bsp") ||
      std::any_of(archive_endings.begin(), archive_endings.end(),
                  [&](std::string_view ending) { return lower.ends_with(ending); })) {
    return true;
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  std::ifstream stream(file, std::ios::binary);
  return kind_of_bytes(first_bytes(stream)).has_value();
}

Level read_level(const std::string& where, LevelNeeds needs) {
  const auto [file, map] = split_place(where);
  const Kind kind = kind_of(file);
  if (kind != Kind::quake && map.empty()) {
    const auto levels = list_levels(file);
    throw FormatError(file.string() + ": holds " + std::to_string(levels.size()) + " levels" +
                      (levels.empty() ? "" : "; name one, such as " + levels.front().where));
  }
  if (kind == Kind::quake && !map.empty())
    throw FormatError(where + ": " + file.string() + " is one level; what stands after it names nothing");
  try {
    Level level = kind == Kind::zip    ? level_of_archive(Pk3(file), map, needs)
                  : kind == Kind::doom ? parse_doom_map(read_whole(file), map)
                                       : parse_quake3_bsp(read_whole(file), {}, visibility_data(needs));
    level.name = file.filename().string() + (map.empty() ? "" : ":" + map);
    return level;
  } catch (const FormatError& error) {
    throw FormatError(where + ": " + error.what());
  }
}

}  // namespace vismat
