// A WAD is a header, lumps, and a directory of (offset, length, 8-character name). A map is an empty lump
// with its name, followed by lumps of fixed names and fixed-size records:
//
//   NODES -> SSECTORS -> SEGS -> LINEDEFS -> SIDEDEFS -> SECTORS, and LINEDEFS -> VERTEXES
//
// so a leaf of the tree finds its sector through its first seg. Every index is checked where it is followed.
#include "visibility/levels/doom_wad.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "visibility/levels/level_tree.h"
#include "visibility/levels/records.h"

namespace vismat {
namespace {

struct Linedef {
  std::uint16_t from, to, flags, special, tag;
  std::array<std::uint16_t, 2> sides;  // right, left; 0xffff for none
};
struct Sidedef {
  std::int16_t x, y;
  char textures[24];
  std::uint16_t sector;
};
struct Vertex {
  std::int16_t x, y;
};
struct Sector {
  std::int16_t floor, ceiling;
  char textures[16];
  std::int16_t light, special, tag;
};
struct Seg {
  std::uint16_t from, to, angle, line, side, offset;
};
struct Subsector {
  std::uint16_t segs, first;
};
struct DoomNode {
  std::int16_t line[4], boxes[8];
  std::array<std::uint16_t, 2> children;  // right, left; the highest bit marks a subsector
};
static_assert(sizeof(Linedef) == 14 && sizeof(Sidedef) == 30 && sizeof(Vertex) == 4 && sizeof(Sector) == 26 &&
              sizeof(Seg) == 12 && sizeof(Subsector) == 4 && sizeof(DoomNode) == 28);

struct DirectoryEntry {
  std::int32_t offset, length;
  char name[8];
};

struct Lump {
  std::string name;
  std::span<const std::byte> bytes;
  std::string damage;  // why it cannot be read; its bytes are then empty
};

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return result;
}

std::vector<Lump> read_wad_directory(std::span<const std::byte> wad) {
  ByteReader header(wad, "WAD header");
  const auto magic = header.number<std::array<char, 4>>();
  if (const std::string_view kind(magic.data(), 4); kind != "IWAD" && kind != "PWAD") {
    throw FormatError("WAD header: does not begin with IWAD or PWAD");
  }
  const auto count = header.number<std::int32_t>(), offset = header.number<std::int32_t>();
  const auto fits = [&](std::int64_t lumps, std::int64_t at) {
    return lumps >= 0 && at >= 0 &&
           at + lumps * static_cast<std::int64_t>(sizeof(DirectoryEntry)) <=
               static_cast<std::int64_t>(wad.size());
  };
  if (!fits(count, offset)) {
    if (fits(with_bytes_reversed(count), with_bytes_reversed(offset)))
      throw FormatError("WAD header: " + big_endian);
    throw FormatError("WAD header: a directory of " + std::to_string(count) + " lumps at offset " +
                      std::to_string(offset) + " lies outside the file of " + std::to_string(wad.size()) +
                      " bytes");
  }
  std::vector<Lump> lumps;
  for (const auto& entry : read_records<DirectoryEntry>(
           wad.subspan(static_cast<std::size_t>(offset), count * sizeof(DirectoryEntry)), "WAD directory")) {
    const std::string name = upper(std::string_view(entry.name, ::strnlen(entry.name, sizeof entry.name)));
    Lump lump{name, {}, ""};
    const std::int64_t lump_end = std::int64_t{entry.offset} + entry.length;
    if (entry.length == 0) {  // a marker: tools leave any offset with it
    } else if (entry.offset < 0 || entry.length < 0 || lump_end > static_cast<std::int64_t>(wad.size())) {
      lump.damage = "WAD directory: lump " + std::to_string(lumps.size()) + " (" + name +
                    "): " + std::to_string(entry.length) + " bytes at offset " +
                    std::to_string(entry.offset) + " lie outside the file of " + std::to_string(wad.size()) +
                    " bytes";
    } else {
      lump.bytes =
          wad.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.length));
    }
    lumps.push_back(std::move(lump));
  }
  return lumps;
}

constexpr std::array<std::string_view, 14> map_lumps = {
    "THINGS",  "LINEDEFS", "SIDEDEFS", "VERTEXES", "SEGS",    "SSECTORS", "NODES",
    "SECTORS", "REJECT",   "BLOCKMAP", "BEHAVIOR", "SCRIPTS", "TEXTMAP",  "ENDMAP"};

bool is_map_lump(std::string_view name) {
  return std::find(map_lumps.begin(), map_lumps.end(), name) != map_lumps.end();
}

// E1M1, MAP01 or MAP101, as the engines name maps; tools allow any other name as well.
bool is_usual_map_name(std::string_view name) {
  std::string shape(name);
  for (char& c : shape) {
    if (c >= '0' && c <= '9') c = '0';
  }
  return shape == "E0M0" || shape == "E0M00" || shape == "MAP00" || shape == "MAP000";
}

struct MapPlace {
  std::string name;
  std::span<const Lump> lumps;  // up to the next map; foreign lumps may lie between those of the map
};

// A map begins at the lump before THINGS, or before TEXTMAP; if foreign lumps lie between, at the usual map name that
// comes before them.
std::vector<MapPlace> places_of_maps(std::span<const Lump> lumps) {
  std::vector<std::size_t> markers;
  std::size_t after_last = 0;             // the lump after the last marker
  std::optional<std::size_t> usual_name;  // the last one since then
  for (std::size_t i = 0; i < lumps.size(); ++i) {
    if (is_usual_map_name(lumps[i].name)) usual_name = i;
    if ((lumps[i].name != "THINGS" && lumps[i].name != "TEXTMAP") || i == after_last) continue;
    const std::size_t marker = usual_name.value_or(i - 1);
    if (is_map_lump(lumps[marker].name)) continue;  // a second THINGS in one map
    markers.push_back(marker);
    after_last = i + 1;
    usual_name.reset();
  }
  std::vector<MapPlace> maps;
  for (std::size_t m = 0; m < markers.size(); ++m) {
    const std::size_t first = markers[m] + 1, end = m + 1 < markers.size() ? markers[m + 1] : lumps.size();
    maps.push_back({lumps[markers[m]].name, lumps.subspan(first, end - first)});
  }
  return maps;
}

class MapLumps {
 public:
  MapLumps(std::span<const Lump> lumps, std::string map) : lumps_(lumps), map_(std::move(map)) {}

  const std::string& map() const { return map_; }
  /// The first lump of that name, or null. Throws FormatError if it lies outside the file.
  const Lump* find(const char* name) const {
    for (const Lump& lump : lumps_) {
      if (lump.name != name) continue;
      if (!lump.damage.empty()) throw FormatError(lump.damage);
      return &lump;
    }
    return nullptr;
  }
  template <typename Record>
  std::vector<Record> records(const char* name) const {
    const Lump* lump = find(name);
    if (lump == nullptr) refuse(name, "is missing");
    return read_records<Record>(lump->bytes, label(name));
  }
  std::string label(const char* name) const { return map_ + ": " + name; }
  [[noreturn]] void refuse(const char* name, const std::string& what) const {
    throw FormatError(label(name) + ": " + what);
  }
  /// values[index], or the refusal of record `user` of lump `name`, which refers to it.
  template <typename Record>
  const Record& follow(const std::vector<Record>& values, std::size_t index, const char* of, const char* name,
                       std::size_t user) const {
    if (index >= values.size()) {
      refuse(name, "record " + std::to_string(user) + ": " + of + " " + std::to_string(index) + " of only " +
                       std::to_string(values.size()));
    }
    return values[index];
  }

 private:
  std::span<const Lump> lumps_;
  std::string map_;
};

constexpr std::uint16_t no_side = 0xffff;

// The sector on each side of each line; none where there is no side.
using LineSectors = std::array<std::optional<std::uint16_t>, 2>;

std::vector<LineSectors> sectors_of_lines(const MapLumps& lumps, std::span<const Linedef> lines,
                                          std::size_t sectors) {
  const auto sides = lumps.records<Sidedef>("SIDEDEFS");
  std::vector<LineSectors> result(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint16_t side = lines[i].sides[k];
      if (side == no_side) continue;
      result[i][k] = lumps.follow(sides, side, "sidedef", "LINEDEFS", i).sector;
      if (*result[i][k] >= sectors) {
        lumps.refuse("SIDEDEFS", "record " + std::to_string(side) + ": sector " +
                                     std::to_string(*result[i][k]) + " of only " + std::to_string(sectors));
      }
    }
  }
  return result;
}

// `notes` gets a line if the table leaves more visible than an author may think.
VisibilityMatrix read_reject(const MapLumps& lumps, std::uint32_t sectors, std::vector<std::string>& notes) {
  const Lump* reject = lumps.find("REJECT");
  const auto bytes = reject == nullptr ? std::span<const std::byte>() : reject->bytes;
  const auto hidden = [&](std::uint64_t bit) {
    return bit / 8 < bytes.size() && (std::to_integer<unsigned>(bytes[bit / 8]) >> (bit % 8) & 1) != 0;
  };
  // Counted before anything is allocated: the lump may be absent however many the sectors are.
  const std::uint64_t pairs = std::uint64_t{sectors} * sectors;
  std::uint64_t visible = pairs;
  for (std::uint64_t bit = 0; bit < std::min<std::uint64_t>(pairs, bytes.size() * 8); ++bit)
    visible -= hidden(bit);
  if (visible > most_visible_pairs) {
    lumps.refuse("REJECT", std::to_string(visible) + " pairs of " + std::to_string(sectors) +
                               " sectors are not rejected; at most " + std::to_string(most_visible_pairs) +
                               " are taken");
  }
  const std::string all = "every sector counts as visible from every other";
  if (const std::uint64_t needed = (pairs + 7) / 8; bytes.empty()) {
    notes.push_back(lumps.map() + " has no REJECT, so " + all);
  } else if (bytes.size() < needed) {
    notes.push_back(lumps.label("REJECT") + " has " + std::to_string(bytes.size()) + " of the " +
                    std::to_string(needed) + " bytes that " + std::to_string(sectors) +
                    " sectors need; pairs past its end count as visible");
  } else if (visible == pairs) {
    notes.push_back(lumps.label("REJECT") + " rejects nothing: " + all);
  }
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> ids;
  ids.reserve(visible);
  for (std::uint32_t from = 0; from < sectors; ++from) {
    for (std::uint32_t to = 0; to < sectors; ++to) {
      if (!hidden(std::uint64_t{from} * sectors + to)) ids.push_back(to);
    }
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr({sectors, sectors}, std::move(offsets), std::move(ids));
}

void add_places(Level& level, const MapLumps& lumps, std::span<const Linedef> lines,
                std::span<const LineSectors> sectors_of_line, std::span<const Sector> sectors) {
  const auto vertices = lumps.records<Vertex>("VERTEXES");
  std::vector<Box> boxes(sectors.size(), empty_box);
  std::vector<std::vector<std::uint32_t>> neighbours(sectors.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto [right, left] = sectors_of_line[i];
    for (const std::uint16_t end : {lines[i].from, lines[i].to}) {
      const Vertex& vertex = lumps.follow(vertices, end, "vertex", "LINEDEFS", i);
      for (const auto sector : {right, left}) {
        if (!sector) continue;
        for (const std::int16_t z : {sectors[*sector].floor, sectors[*sector].ceiling}) {
          grow(boxes[*sector], glm::vec3(vertex.x, vertex.y, z) * metres_per_level_unit);
        }
      }
    }
    if (right && left && right != left) {
      neighbours[*right].push_back(*left);
      neighbours[*left].push_back(*right);
    }
  }
  for (const Box& box : boxes) level.cell_bounds.push_back(zero_if_empty(box));
  for (auto& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  level.cell_neighbours = VisibilityMatrix::from_rows(neighbours, static_cast<std::uint32_t>(sectors.size()));
}

// Whether the tree is there and in the classic format. Node builders mark the others at the start of NODES, or of
// SSECTORS if they also hold what OpenGL needs.
bool has_classic_nodes(const MapLumps& lumps) {
  constexpr std::array<std::string_view, 9> extended = {"xNd4", "XNOD", "ZNOD", "XGLN", "ZGLN",
                                                        "XGL2", "ZGL2", "XGL3", "ZGL3"};
  for (const char* name : {"NODES", "SSECTORS"}) {
    const Lump* lump = lumps.find(name);
    if (lump == nullptr || lump->bytes.size() < 4) {
      if (std::string_view(name) == "NODES") return false;
      continue;
    }
    const std::string_view magic(reinterpret_cast<const char*>(lump->bytes.data()), 4);
    if (std::find(extended.begin(), extended.end(), magic) != extended.end()) return false;
  }
  return true;
}

ObjectTree read_tree(const MapLumps& lumps, std::span<const LineSectors> sectors_of_line,
                     std::uint32_t sectors) {
  if (!has_classic_nodes(lumps)) return {};
  const auto segs = lumps.records<Seg>("SEGS");
  const auto subsectors = lumps.records<Subsector>("SSECTORS");
  std::vector<BspChildren> nodes;
  for (const DoomNode& node : lumps.records<DoomNode>("NODES")) {
    const auto child = [](std::uint16_t c) -> std::int32_t {
      return c & 0x8000 ? ~std::int32_t{c & 0x7fff} : c;
    };
    nodes.push_back({child(node.children[0]), child(node.children[1])});
  }
  std::vector<std::vector<std::uint32_t>> sector_of_leaf(subsectors.size());
  for (std::size_t i = 0; i < subsectors.size(); ++i) {
    const Seg& seg = lumps.follow(segs, subsectors[i].first, "seg", "SSECTORS", i);
    if (seg.line >= sectors_of_line.size() || seg.side > 1 || !sectors_of_line[seg.line][seg.side]) {
      lumps.refuse("SEGS", "record " + std::to_string(subsectors[i].first) + ": side " +
                               std::to_string(seg.side) + " of line " + std::to_string(seg.line) +
                               " does not exist");
    }
    sector_of_leaf[i] = {*sectors_of_line[seg.line][seg.side]};
  }
  const auto walk = walk_bsp(nodes, static_cast<std::uint32_t>(nodes.size() - 1),
                             static_cast<std::uint32_t>(subsectors.size()), lumps.label("NODES"));
  return level_tree(walk, VisibilityMatrix::from_rows(sector_of_leaf, sectors));
}

}  // namespace

std::vector<WadMap> doom_maps(std::span<const std::byte> wad) {
  const auto lumps = read_wad_directory(wad);
  std::vector<WadMap> maps;
  for (const MapPlace& place : places_of_maps(lumps)) {
    maps.push_back({place.name});
    for (const Lump& lump : place.lumps) {
      if (is_map_lump(lump.name)) maps.back().bytes += lump.bytes.size();
    }
  }
  return maps;
}

Level parse_doom_map(std::span<const std::byte> wad, std::string_view map) {
  const std::string name = upper(map);
  const auto directory = read_wad_directory(wad);
  const auto maps = places_of_maps(directory);
  const auto last =
      std::find_if(maps.rbegin(), maps.rend(), [&](const MapPlace& m) { return m.name == name; });
  if (last == maps.rend()) {
    std::string there;
    for (std::size_t i = 0; i < std::min<std::size_t>(maps.size(), 5); ++i)
      there += (i > 0 ? ", " : "") + maps[i].name;
    throw FormatError("no map " + name + "; there " + (maps.empty() ? "is none" : "are " + there) +
                      (maps.size() > 5 ? " and " + std::to_string(maps.size() - 5) + " more" : ""));
  }
  const MapLumps lumps(last->lumps, name);
  if (lumps.find("TEXTMAP") != nullptr) {
    throw FormatError(name + ": is in the text format UDMF; only Doom's binary maps are read");
  }
  if (lumps.find("BEHAVIOR") != nullptr)
    throw FormatError(name + ": is in Hexen's format; only Doom's is read");

  const auto sectors = lumps.records<Sector>("SECTORS");
  if (sectors.empty() || sectors.size() > 65536) {
    lumps.refuse("SECTORS", std::to_string(sectors.size()) + " sectors; a map has 1 to 65536");
  }
  const auto count = static_cast<std::uint32_t>(sectors.size());
  const auto lines = lumps.records<Linedef>("LINEDEFS");
  const auto sectors_of_line = sectors_of_lines(lumps, lines, sectors.size());
  Level level;
  level.format = "Doom";
  level.cells_are = "sector";
  level.cells = read_reject(lumps, count, level.notes);
  add_places(level, lumps, lines, sectors_of_line, sectors);
  level.cell_tree = read_tree(lumps, sectors_of_line, count);
  return level;
}

}  // namespace vismat
