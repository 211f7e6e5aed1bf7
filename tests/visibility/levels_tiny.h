// Levels of a few records with known answers, as bytes: tests change a field or two and build.
#pragma once
#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/refusal.h"

namespace vismat::tiny {

using Bytes = std::vector<std::byte>;

template <typename Number>
void put(Bytes& out, Number number) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&number);
  out.insert(out.end(), bytes, bytes + sizeof number);
}
inline void put_text(Bytes& out, std::string_view text, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i)
    out.push_back(static_cast<std::byte>(i < text.size() ? text[i] : '\0'));
}
template <typename Number>
Bytes bytes_of(const std::vector<Number>& numbers) {
  Bytes out;
  for (const Number number : numbers) put(out, number);
  return out;
}

/// Three clusters in a row along x, each a cube of 64 units (2 m), cluster 1 with a second one behind it in
/// y.
struct Quake {
  struct Leaf {
    std::int32_t cluster;
    std::array<std::int32_t, 6> box;
    std::int32_t first_face, faces;
  };
  struct Face {
    std::int32_t type, first_vertex, vertices, first_index, indices, width = 0, height = 0;
    std::array<float, 3> origin{};
    std::int32_t shader = 0;
  };
  std::vector<std::array<std::uint32_t, 2>> shaders = {{0, 1}};  // flags: surface, contents
  std::string shader_name = "textures/base";
  std::array<char, 4> magic = {'I', 'B', 'S', 'P'};
  std::int32_t version = 46, clusters = 3, row_bytes = 8;
  std::string entities = "{}";
  std::vector<std::array<float, 4>>
      planes;  // one for each node: x, y, z, distance; none: nobody asks where a point lies
  std::vector<std::array<std::int32_t, 2>> nodes = {{1, 2}, {-2, -3}, {3, -5}, {-4, -6}};
  std::vector<Leaf> leafs = {{0, {0, 0, 0, 0, 0, 0}, 0, 0},  // no node leads here
                             {0, {0, 0, 0, 64, 64, 64}, 0, 2},    {1, {64, 0, 0, 128, 64, 64}, 2, 2},
                             {-1, {-9, -9, -9, 9, 9, 9}, 4, 0},  // solid
                             {2, {128, 0, 0, 192, 64, 64}, 4, 1}, {1, {64, 64, 0, 128, 128, 64}, 5, 1},
                             {0, {0, 0, 0, 0, 0, 0}, 6, 1}};  // a mover; no node leads here
  std::vector<std::int32_t> leaffaces = {0, 1, 1, 2, 3, 2, 5};
  std::vector<std::array<float, 3>> vertexes;
  std::vector<std::int32_t> meshverts = {0, 1, 2, 0, 2, 3, 0, 1, 2};
  std::vector<Face> faces = {{1, 0, 4, 0, 6},                            // a quad: two triangles
                             {3, 1, 3, 6, 3},                            // a mesh of one
                             {2, 4, 9, 0, 0, 3, 3},                      // a patch
                             {4, 0, 0, 0, 0, 0, 0, {160, 32, 32}},       // a billboard
                             {1, 0, 4, 0, 6},                            // in no leaf
                             {1, 0, 4, 0, 3}};                           // the mover's
  std::vector<std::uint8_t> rows = {0b10000011, 0xff, 0, 0, 0, 0, 0, 0,  // junk past the third bit
                                    0b111,      0,    0, 0, 0, 0, 0, 0, 0b110, 0, 0, 0, 0, 0, 0, 0};
  bool has_visdata = true;
  int last_lump = 16;  // stands at the file's end

  Quake() {
    vertexes = {{0, 0, 0}, {64, 0, 0}, {64, 64, 0}, {0, 64, 0}};
    // A parabola along x: heights 0, 32, 0 at the control points, so 16 in the middle.
    for (const float y : {0.f, 32.f, 64.f}) {
      for (const float x : {64.f, 96.f, 128.f}) vertexes.push_back({x, y, x == 96 ? 32.f : 0.f});
    }
  }

  std::array<Bytes, 17> lumps() const {
    std::array<Bytes, 17> lumps;
    put_text(lumps[0], entities, entities.size() + 1);
    lumps[2] = bytes_of(planes);
    for (const auto& [surface, contents] : shaders) {
      put_text(lumps[1], shader_name, 64);
      put(lumps[1], surface);
      put(lumps[1], contents);
    }
    for (std::int32_t i = 0; const auto& node : nodes) {
      const std::int32_t plane = planes.empty() ? 0 : i++;
      for (const std::int32_t field : {plane, node[0], node[1], 0, 0, 0, 0, 0, 0}) put(lumps[3], field);
    }
    for (const Leaf& leaf : leafs) {
      put(lumps[4], leaf.cluster);
      put(lumps[4], std::int32_t{0});
      for (const std::int32_t edge : leaf.box) put(lumps[4], edge);
      for (const std::int32_t field : {leaf.first_face, leaf.faces, 0, 0}) put(lumps[4], field);
    }
    lumps[5] = bytes_of(leaffaces);
    for (const auto& vertex : vertexes) {
      for (const float x : vertex) put(lumps[10], x);
      lumps[10].resize(lumps[10].size() + 32);
    }
    lumps[11] = bytes_of(meshverts);
    for (const Face& face : faces) {
      for (const std::int32_t field : {face.shader, -1, face.type, face.first_vertex, face.vertices,
                                       face.first_index, face.indices, 0, 0, 0, 0, 0}) {
        put(lumps[13], field);
      }
      for (const float x : face.origin) put(lumps[13], x);
      lumps[13].resize(lumps[13].size() + 36);
      put(lumps[13], face.width);
      put(lumps[13], face.height);
    }
    if (has_visdata) {
      put(lumps[16], clusters);
      put(lumps[16], row_bytes);
      for (const std::uint8_t byte : rows) put(lumps[16], byte);
    }
    return lumps;
  }

  Bytes bytes() const {
    const auto all = lumps();
    std::array<std::int32_t, 17> offsets{};
    Bytes body;
    const auto append = [&](int lump) {
      offsets[lump] = static_cast<std::int32_t>(144 + body.size());
      body.insert(body.end(), all[lump].begin(), all[lump].end());
    };
    for (int i = 0; i < 17; ++i) {
      if (i != last_lump) append(i);
    }
    append(last_lump);
    Bytes file;
    for (const char c : magic) file.push_back(static_cast<std::byte>(c));
    put(file, version);
    for (int i = 0; i < 17; ++i) {
      put(file, offsets[i]);
      put(file, static_cast<std::int32_t>(all[i].size()));
    }
    file.insert(file.end(), body.begin(), body.end());
    return file;
  }
};

/// Three sectors in a row along x, each 64 units square; the first is a closed door, the last looks not at
/// the first.
struct Doom {
  std::string magic = "PWAD", map = "MAP07";
  std::vector<std::array<std::int16_t, 2>> vertexes = {{0, 0},  {64, 0},  {128, 0},  {192, 0},
                                                       {0, 64}, {64, 64}, {128, 64}, {192, 64}};
  struct Line {
    std::uint16_t from, to, right, left;
  };
  static constexpr std::uint16_t none = 0xffff;
  std::vector<Line> lines = {{1, 0, 0, none}, {0, 4, 0, none}, {4, 5, 0, none}, {5, 1, 1, 2},
                             {2, 1, 2, none}, {5, 6, 2, none}, {6, 2, 3, 4},    {3, 2, 4, none},
                             {7, 3, 4, none}, {6, 7, 4, none}};
  std::vector<std::uint16_t> sector_of_side = {0, 0, 1, 1, 2};
  std::vector<std::array<std::int16_t, 2>> sectors = {{32, 0}, {0, 128}, {-64, 64}};  // floor, ceiling
  std::vector<std::uint8_t> reject = {0b01000100, 0};  // 0 and 2 see not one another
  struct Seg {
    std::uint16_t line, side;
  };
  std::vector<Seg> segs = {{0, 0}, {3, 1}, {7, 0}};
  std::vector<std::uint16_t> first_segs = {0, 1, 2};
  std::vector<std::array<std::uint16_t, 2>> nodes = {{0x8000, 0x8001}, {0, 0x8002}};
  std::vector<std::string> left_out;  // lumps
  std::string extra_lump;             // after BLOCKMAP
  std::string foreign_before;         // a lump of a few bytes stands before the lump of this name
  std::string outside;                // this lump's bytes lie outside the file

  std::vector<std::pair<std::string, Bytes>> lumps() const {
    std::vector<std::pair<std::string, Bytes>> all = {{map, {}}, {"THINGS", {}}};
    const auto add = [&](const std::string& name) -> Bytes& {
      all.push_back({name, {}});
      return all.back().second;
    };
    for (const Line& line : lines) {
      Bytes& out = add_once(all, "LINEDEFS");
      for (const unsigned field : {+line.from, +line.to, 0, 0, 0, +line.right, +line.left}) {
        put(out, static_cast<std::uint16_t>(field));
      }
    }
    for (const std::uint16_t sector : sector_of_side) {
      Bytes& out = add_once(all, "SIDEDEFS");
      out.resize(out.size() + 28);
      put(out, sector);
    }
    Bytes& points = add("VERTEXES");
    for (const auto& vertex : vertexes) {
      for (const std::int16_t x : vertex) put(points, x);
    }
    Bytes& pieces = add("SEGS");
    for (const Seg& seg : segs) {
      for (const unsigned field : {0, 0, 0, +seg.line, +seg.side, 0})
        put(pieces, static_cast<std::uint16_t>(field));
    }
    Bytes& leafs = add("SSECTORS");
    for (const std::uint16_t first : first_segs) {
      put(leafs, std::uint16_t{1});
      put(leafs, first);
    }
    Bytes& tree = add("NODES");
    for (const auto& node : nodes) {
      tree.resize(tree.size() + 24);
      for (const std::uint16_t child : node) put(tree, child);
    }
    Bytes& rooms = add("SECTORS");
    for (const auto& sector : sectors) {
      for (const std::int16_t z : sector) put(rooms, z);
      rooms.resize(rooms.size() + 22);
    }
    add("REJECT") = bytes_of(reject);
    add("BLOCKMAP");
    if (!extra_lump.empty()) add(extra_lump);
    return all;
  }

  Bytes bytes() const {
    Bytes body, directory;
    std::int32_t count = 0;
    for (const auto& [name, lump] : lumps()) {
      bool skip = false;
      for (const std::string& out : left_out) skip = skip || out == name;
      if (skip) continue;
      if (name == foreign_before) {
        put(directory, static_cast<std::int32_t>(12));
        put(directory, std::int32_t{7});
        put_text(directory, "CWILV00", 8);
        ++count;
      }
      put(directory, name == outside ? std::int32_t{1000000} : static_cast<std::int32_t>(12 + body.size()));
      put(directory, static_cast<std::int32_t>(lump.size()));
      put_text(directory, name, 8);
      body.insert(body.end(), lump.begin(), lump.end());
      ++count;
    }
    Bytes file;
    put_text(file, magic, 4);
    put(file, count);
    put(file, static_cast<std::int32_t>(12 + body.size()));
    file.insert(file.end(), body.begin(), body.end());
    file.insert(file.end(), directory.begin(), directory.end());
    return file;
  }

 private:
  static Bytes& add_once(std::vector<std::pair<std::string, Bytes>>& all, const char* name) {
    if (all.back().first != name) all.push_back({name, {}});
    return all.back().second;
  }
};

struct ZipMember {
  std::string name;
  Bytes bytes;
  bool deflated = false;
  std::int64_t claimed_size = -1;  // uncompressed; -1: the true one
  bool encrypted = false;          // says so; its bytes stay as they are
};
inline Bytes zip(const std::vector<ZipMember>& members) {
  Bytes file, directory;
  for (const ZipMember& member : members) {
    Bytes data = member.bytes;
    if (member.deflated) {
      z_stream stream{};
      deflateInit2(&stream, 1, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
      data.resize(deflateBound(&stream, member.bytes.size()));
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(member.bytes.data()));
      stream.avail_in = static_cast<uInt>(member.bytes.size());
      stream.next_out = reinterpret_cast<Bytef*>(data.data());
      stream.avail_out = static_cast<uInt>(data.size());
      deflate(&stream, Z_FINISH);
      data.resize(stream.total_out);
      deflateEnd(&stream);
    }
    const auto crc = static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(member.bytes.data()),
                                                      static_cast<uInt>(member.bytes.size())));
    const auto offset = static_cast<std::uint32_t>(file.size());
    const auto size =
        static_cast<std::uint32_t>(member.claimed_size < 0 ? member.bytes.size() : member.claimed_size);
    const auto common = [&](Bytes& out) {  // what the local header and the directory's entry share
      for (const int field : {20, member.encrypted ? 1 : 0, member.deflated ? 8 : 0, 0, 33})
        put(out, static_cast<std::uint16_t>(field));
      put(out, crc);
      put(out, static_cast<std::uint32_t>(data.size()));
      put(out, size);
      put(out, static_cast<std::uint16_t>(member.name.size()));
      put(out, std::uint16_t{0});
    };
    put_text(file, "PK\3\4", 4);
    common(file);
    put_text(file, member.name, member.name.size());
    file.insert(file.end(), data.begin(), data.end());
    put_text(directory, "PK\1\2", 4);
    put(directory, std::uint16_t{20});
    common(directory);
    directory.resize(directory.size() + 10);
    put(directory, offset);
    put_text(directory, member.name, member.name.size());
  }
  const auto start = static_cast<std::uint32_t>(file.size());
  file.insert(file.end(), directory.begin(), directory.end());
  put_text(file, "PK\5\6", 4);
  put(file, std::uint32_t{0});
  for (int i = 0; i < 2; ++i) put(file, static_cast<std::uint16_t>(members.size()));
  put(file, static_cast<std::uint32_t>(directory.size()));
  put(file, start);
  put(file, std::uint16_t{0});
  return file;
}

}  // namespace vismat::tiny
