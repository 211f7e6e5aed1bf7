// ALGORITHM. Each square of a grid draws from its own random stream, so squares do not depend on one another. A strip along its
// low x and low y stays free: these are the streets, straight and joined. On the rest, a pavement of 1 m round it, stands a
// building, or cars. Buildings are lattices: a plain box, an L or a T, with windows set back or with ledges; or a house
// of four rooms on each storey, whose walls are 0.3 m thick and have openings. Sizes are those of the city on which our goals for
// producers were set (20 m pitch, 12 m footprints, 6 to 30 m high, 4 m cells at eye height), made of triangles of 1.4 m
// at most, so that no triangle by itself hides anything from a cell.
#include "visibility/generators/dense_city.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/vec2.hpp>
#include <span>
#include <stdexcept>

#include "matrix/base/random.h"
#include "visibility/generators/solids.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat {
namespace {

constexpr float pavement = 1;
constexpr float storey = 3, slab = 0.3f, wall_depth = 0.3f, door = 1.2f, sill = 0.9f, lintel = 2.1f;
const glm::vec3 up(0, 0, 1);

void check(const DenseCityOptions& o) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("dense city: " + what); };
  if (o.size < 1 || o.size > 256) refuse("size " + std::to_string(o.size) + " is not from 1 to 256");
  for (const float length : {o.pitch, o.street, o.lowest, o.step, o.cell, o.eye_low}) {
    if (!(length >= 0.1f && length <= 1e4f)) refuse("lengths must be 0.1 to 10000 m");
  }
  if (!(o.smallest_side >= 6)) refuse("the smallest side must be at least 6 m, for rooms and doors");
  if (!(o.largest_side >= o.smallest_side && o.highest >= o.lowest && o.eye_high >= o.eye_low)) {
    refuse("the largest of something is below its smallest");
  }
  if (!(o.highest <= 1e4f && o.eye_high <= 1e4f)) refuse("heights must be at most 10000 m");
  if (!(o.largest_side + o.street + 2 * pavement <= o.pitch)) {
    refuse("a largest side, a street and two pavements of 1 m do not fit into the pitch");
  }
  for (const float share : {o.interiors, o.car_parks}) {
    if (!(share >= 0 && share <= 1)) refuse("shares must lie between 0 and 1");
  }
  if (o.car_sides < 8 || o.car_sides > 256) refuse("a car's body has 8 to 256 sides");
}

/// One square of the city while it is built.
struct Square {
  SceneFile& city;
  std::vector<Box>& obstacles;  // what keeps view cells away
  const DenseCityOptions& o;
  Random random;
  float x, y;  // its corner

  bool chance(float probability) { return random.unit() < probability; }
  void finish_object(const Box& bounds) {
    ++city.scene.object_count;
    obstacles.push_back(bounds);
  }
};

/// Walls, set back where windows are, or with a ledge at every storey.
void add_building(Square& s, const Box& b) {
  enum Style { plain, windows, ledges };
  const std::uint32_t kind = s.random.below(4);
  const Style style = kind < 2 ? plain : kind == 2 ? windows : ledges;
  const std::uint32_t shape = s.random.below(4);
  const float depth = 0.25f;
  std::array<std::vector<float>, 3> cuts = {
      {{b.low[0], b.high[0]}, {b.low[1], b.high[1]}, {b.low[2], b.high[2]}}};
  std::array<float, 2> middle;
  for (unsigned axis = 0; axis < 2; ++axis) {
    const float side = b.high[axis] - b.low[axis];
    middle[axis] = b.low[axis] + side * s.random.between(0.4f, 0.6f);
    if (shape >= 2) cuts[axis].push_back(middle[axis]);
    if (style == windows) cuts[axis].insert(cuts[axis].end(), {b.low[axis] + depth, b.high[axis] - depth});
    if (style == ledges) cuts[axis].insert(cuts[axis].end(), {b.low[axis] - depth, b.high[axis] + depth});
  }
  const float bay = b.low[0] + (b.high[0] - b.low[0]) / 4;
  if (shape == 3) cuts[0].push_back(bay);
  if (style == ledges) {
    for (float z = storey; z + slab < b.high[2]; z += storey) cuts[2].insert(cuts[2].end(), {z, z + slab});
  }
  Lattice body(cuts, s.o.step);
  body.set(b, true);
  if (shape == 2) body.set({{middle[0], middle[1], 0}, b.high}, false);  // an L
  if (shape == 3) {                                                      // a T
    body.set({{b.low[0], middle[1], 0}, {bay, b.high[1], b.high[2]}}, false);
    body.set({{middle[0], middle[1], 0}, b.high}, false);
  }
  for (unsigned axis = 0; axis < 2 && style == windows; ++axis) {
    const unsigned along = 1 - axis;
    for (const int layer : {0, body.cells(axis) - 1}) {
      const int inward = layer == 0 ? 1 : -1;
      std::array<int, 3> at{};
      at[axis] = layer;
      for (at[2] = 1; at[2] + 1 < body.cells(2); at[2] += 2) {
        for (at[along] = 2; at[along] + 2 < body.cells(along); at[along] += 2) {
          // Not beside a notch: there a hole would meet open air in an edge alone.
          bool whole = true;
          for (int d = -1; d <= 1; ++d) {
            std::array<int, 3> beside = at;
            beside[along] += d;
            whole = whole && body.filled(beside);
            beside[axis] += inward;
            whole = whole && body.filled(beside);
          }
          if (whole) body.set_cell(at, false);
        }
      }
    }
  }
  if (style == ledges) {
    Lattice bare = body;
    for (int z = 0; z < body.cells(2); ++z) {
      const float middle_z = (body.planes(2)[z] + body.planes(2)[z + 1]) / 2;
      if (middle_z < storey || std::fmod(middle_z, storey) > slab) continue;
      for (unsigned axis = 0; axis < 2; ++axis) {
        for (const int layer : {0, body.cells(axis) - 1}) {
          std::array<int, 3> at{};
          at[axis] = layer;
          at[2] = z;
          for (at[1 - axis] = 0; at[1 - axis] < body.cells(1 - axis); ++at[1 - axis]) {
            std::array<int, 3> inner = at;
            inner[axis] += layer == 0 ? 1 : -1;
            if (bare.filled(inner)) body.set_cell(at, true);
          }
        }
      }
    }
  }
  body.add_to(s.city.scene);
  Box bounds = b;
  for (unsigned axis = 0; axis < 2 && style == ledges; ++axis)
    bounds.low[axis] -= depth, bounds.high[axis] += depth;
  s.finish_object(bounds);
}

/// A superellipsoid, long along x or y, with a lower bonnet and boot, on four wheels.
void add_car(Square& s, float x, float y, bool along_y) {
  const float length = s.random.between(3.8f, 4.8f), width = s.random.between(1.65f, 1.85f);
  const float height = s.random.between(1.3f, 1.7f), clearance = 0.25f;
  const float cabin = s.random.between(-0.15f, 0.05f);
  const auto place = [&](double u, double v, double z) {
    // A quarter turn, not a reflection, so that orientation stays.
    const double dx = along_y ? -v : u, dy = along_y ? u : v;
    return glm::vec3(glm::dvec3(x + dx, y + dy, z));
  };
  const unsigned sides = s.o.car_sides, rings = s.o.car_sides - 1;
  const auto power = [](double base, double exponent) {
    return std::copysign(std::pow(std::abs(base), exponent), base);
  };
  const double pi = 3.141592653589793, lower = (height - clearance) * 0.45,
               upper = (height - clearance) * 0.55;
  const auto surface = [&](double theta, double phi) {
    const double u = -power(std::cos(theta), 0.5) * length / 2, round = power(std::sin(theta), 0.5);
    const double v = power(std::cos(phi), 0.6) * round * width / 2, w = power(std::sin(phi), 0.6) * round;
    const double t = 2 * u / length - cabin, roof = 0.25 + 0.75 * std::exp(-t * t * t * t * 12);
    return place(u, v, clearance + lower + (w > 0 ? w * upper * roof : w * lower));
  };
  std::vector<std::vector<glm::vec3>> body(rings);
  for (unsigned r = 0; r < rings; ++r) {
    for (unsigned i = 0; i < sides; ++i)
      body[r].push_back(surface(pi * (r + 1) / (rings + 1), -2 * pi * i / sides));
  }
  add_loft(s.city.scene, surface(0, 0), body, surface(pi, 0));
  const glm::vec3 axle = along_y ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  for (const float end : {-0.3f, 0.3f}) {
    for (const float side : {-0.5f, 0.5f}) {
      const glm::vec3 hub = place(end * length, side * (width - 0.2f), 0.3f);
      const glm::vec3 half = axle * 0.1f;
      const std::vector<std::vector<glm::vec3>> rim = {circle(hub - half, axle, 0.3f, 16),
                                                       circle(hub + half, axle, 0.3f, 16)};
      add_loft(s.city.scene, hub - half, rim, hub + half);
    }
  }
  const float dx = (along_y ? width : length) / 2, dy = (along_y ? length : width) / 2;
  s.finish_object({{x - dx, y - dy, 0}, {x + dx, y + dy, height}});
}

/// A slab on four legs.
void add_table(Square& s, const glm::vec3& low, const glm::vec3& size, float leg, float top) {
  std::array<std::vector<float>, 3> cuts;
  for (int axis = 0; axis < 2; ++axis) {
    cuts[axis] = {low[axis], low[axis] + leg, low[axis] + size[axis] - leg, low[axis] + size[axis]};
  }
  cuts[2] = {low.z, low.z + size.z - top, low.z + size.z};
  Lattice table(cuts, s.o.step);
  const Box bounds = {{cuts[0][0], cuts[1][0], cuts[2][0]}, {cuts[0][3], cuts[1][3], cuts[2][2]}};
  table.set(bounds, true);
  table.set({{cuts[0][1], cuts[1][0], cuts[2][0]}, {cuts[0][2], cuts[1][3], cuts[2][1]}}, false);
  table.set({{cuts[0][0], cuts[1][1], cuts[2][0]}, {cuts[0][3], cuts[1][2], cuts[2][1]}}, false);
  table.add_to(s.city.scene);
  s.finish_object(bounds);
}

/// A table in the middle, something on it, a cupboard in the corner.
void add_furniture(Square& s, const glm::vec3& corner, const glm::vec2& middle) {
  constexpr float high = 0.75f;
  add_table(s, {middle.x - 0.6f, middle.y - 0.4f, corner.z}, {1.2f, 0.8f, high}, 0.06f, 0.05f);
  if (s.chance(0.5f)) {
    const std::array<Turn, 6> vase = {
        {{0, 0.06f}, {0.05f, 0.11f}, {0.15f, 0.12f}, {0.22f, 0.06f}, {0.27f, 0.05f}, {0.3f, 0.08f}}};
    add_turned(s.city.scene, {middle, corner.z + high}, up, 0, vase, 0.3f, 16);
    s.finish_object({{middle.x, middle.y, corner.z}, {middle.x, middle.y, corner.z}});
  }
  const Box cupboard = {
      {corner.x + 0.05f, corner.y + 0.05f, corner.z},
      {corner.x + s.random.between(0.5f, 1.f), corner.y + 0.5f, corner.z + s.random.between(1.f, 2.f)}};
  add_box(s.city.scene, cupboard, 0.5f);
  s.finish_object(cupboard);
}

/// Four rooms a storey, four storeys at most; a window in each outer wall of a room, doors between rooms and to the street.
void add_house(Square& s, Box b) {
  const auto storeys = std::clamp(static_cast<unsigned>(b.high[2] / storey), 1u, 4u);
  b.high[2] = static_cast<float>(storeys) * storey;
  std::array<std::array<Box, 2>, 2> rooms{};  // [y][x]; heights are those of a storey
  std::array<std::vector<float>, 3> cuts = {{{b.low[0], b.high[0]}, {b.low[1], b.high[1]}, {b.high[2]}}};
  std::array<std::array<float, 2>, 2> opening{};  // [axis][room]: middles of doors and windows
  std::array<float, 2> partition{};
  for (unsigned axis = 0; axis < 2; ++axis) {
    partition[axis] = (b.low[axis] + b.high[axis] - wall_depth) / 2;
    const std::array<float, 4> sides = {b.low[axis] + wall_depth, partition[axis],
                                        partition[axis] + wall_depth, b.high[axis] - wall_depth};
    cuts[axis].insert(cuts[axis].end(), sides.begin(), sides.end());
    for (unsigned room = 0; room < 2; ++room) {
      opening[axis][room] = (sides[2 * room] + sides[2 * room + 1]) / 2;
      cuts[axis].insert(cuts[axis].end(), {opening[axis][room] - door / 2, opening[axis][room] + door / 2});
      for (unsigned other = 0; other < 2; ++other) {
        Box& r = axis == 0 ? rooms[other][room] : rooms[room][other];
        r.low[axis] = sides[2 * room];
        r.high[axis] = sides[2 * room + 1];
      }
    }
  }
  for (unsigned k = 0; k < storeys; ++k) {
    const float floor = static_cast<float>(k) * storey;
    cuts[2].insert(cuts[2].end(), {floor, floor + sill, floor + lintel, floor + storey - slab});
  }
  Lattice house(cuts, s.o.step);
  house.set(b, true);
  for (unsigned k = 0; k < storeys; ++k) {
    const float floor = static_cast<float>(k) * storey;
    for (const auto& row : rooms) {
      for (Box room : row) {
        room.low[2] = floor;
        room.high[2] = floor + storey - slab;
        house.set(room, false);
      }
    }
    for (unsigned axis = 0; axis < 2; ++axis) {
      for (unsigned room = 0; room < 2; ++room) {
        const auto open = [&](float from, float to, float bottom) {
          Box hole;
          hole.low[axis] = from;
          hole.high[axis] = to;
          hole.low[1 - axis] = opening[1 - axis][room] - door / 2;
          hole.high[1 - axis] = opening[1 - axis][room] + door / 2;
          hole.low[2] = floor + bottom;
          hole.high[2] = floor + lintel;
          house.set(hole, false);
        };
        open(partition[axis], partition[axis] + wall_depth, 0);
        open(b.low[axis], b.low[axis] + wall_depth, k == 0 && room == 0 ? 0 : sill);
        open(b.high[axis] - wall_depth, b.high[axis], sill);
      }
    }
  }
  house.add_to(s.city.scene);
  s.finish_object(b);
  for (unsigned k = 0; k < storeys; ++k) {
    for (const auto& row : rooms) {
      for (const Box& room : row) {
        add_furniture(s, {room.low[0], room.low[1], static_cast<float>(k) * storey},
                      {(room.low[0] + room.high[0]) / 2, (room.low[1] + room.high[1]) / 2});
      }
    }
  }
}

void add_car_park(Square& s) {
  const std::uint32_t cars = 4 + s.random.below(5);
  const bool along_y = s.chance(0.5f);
  const float from = s.o.street + pavement, room = s.o.pitch - from - pavement;
  for (std::uint32_t car = 0; car < cars; ++car) {
    const float along = from + room * (car % 2 == 0 ? 0.25f : 0.75f) + s.random.between(-0.2f, 0.2f);
    const float across =
        from + room * (static_cast<float>(car / 2) + 0.5f) / 4 + s.random.between(-0.1f, 0.1f);
    add_car(s, s.x + (along_y ? across : along), s.y + (along_y ? along : across), along_y);
  }
}

/// Lamps, trees, bins and benches on the two pavements along the streets.
void add_street_furniture(Square& s) {
  const std::uint32_t slots = 4;
  for (std::uint32_t i = 0; i < 2 * slots; ++i) {
    const float along = s.o.street + 2 + (s.o.pitch - s.o.street - 3) * static_cast<float>(i / 2) / slots;
    const float across = s.o.street + pavement / 2;
    const bool along_y = i % 2 == 1;
    const glm::vec3 base(s.x + (along_y ? across : along), s.y + (along_y ? along : across), 0);
    const auto turned = [&](std::span<const Turn> profile, unsigned sides) {
      add_turned(s.city.scene, base, up, profile.front().along, profile, profile.back().along, sides);
      float radius = 0;
      for (const Turn& turn : profile) radius = std::max(radius, turn.radius);
      s.finish_object(
          {{base.x - radius, base.y - radius, 0}, {base.x + radius, base.y + radius, profile.back().along}});
    };
    switch (s.random.below(10)) {
      case 0:  // a lamp
        turned(std::array<Turn, 7>{{{0, 0.1f},
                                    {0.2f, 0.1f},
                                    {0.3f, 0.05f},
                                    {4.2f, 0.05f},
                                    {4.3f, 0.2f},
                                    {4.6f, 0.25f},
                                    {4.7f, 0.1f}}},
               10);
        break;
      case 1: {  // a slender tree
        const float high = s.random.between(4.f, 7.f);
        std::vector<Turn> tree = {{0, 0.12f}, {1, 0.1f}, {1.2f, 0.2f}};
        for (int k = 1; k <= 10; ++k) {
          const float t = static_cast<float>(k) / 10;
          tree.push_back(
              {1.2f + (high - 1.2f) * t, 0.45f * std::sin(2.9f * std::sqrt(t)) + 0.02f + 0.1f * (1 - t)});
        }
        turned(tree, 14);
        break;
      }
      case 2:  // a bin
        turned(std::array<Turn, 4>{{{0, 0.2f}, {0.8f, 0.25f}, {0.9f, 0.25f}, {0.95f, 0.15f}}}, 12);
        break;
      case 3:  // a bench
        add_table(s, {base.x - 0.25f, base.y - 0.25f, 0}, {0.5f, 0.5f, 0.45f}, 0.06f, 0.06f);
        break;
      default:
        break;
    }
  }
}

void fill_square(Square& s) {
  if (s.chance(s.o.car_parks)) return add_car_park(s);
  Box b;
  const std::array<float, 2> corner = {s.x, s.y};
  for (unsigned axis = 0; axis < 2; ++axis) {
    const float side = s.random.between(s.o.smallest_side, s.o.largest_side);
    const float from = s.o.street + pavement;
    b.low[axis] = corner[axis] + s.random.between(from, s.o.pitch - pavement - side);
    b.high[axis] = b.low[axis] + side;
  }
  b.high[2] = s.random.between(s.o.lowest, s.o.highest);
  if (s.chance(s.o.interiors)) {
    add_house(s, b);
  } else {
    add_building(s, b);
  }
  add_street_furniture(s);
}

/// The grid's boxes that meet no obstacle; touching is not meeting.
std::vector<Box> free_cells(const DenseCityOptions& o, float side, const std::vector<Box>& obstacles) {
  const auto cells = static_cast<std::uint32_t>(side / o.cell);
  std::vector<std::uint8_t> taken(std::size_t{cells} * cells);
  for (const Box& b : obstacles) {
    if (b.high[2] <= o.eye_low || b.low[2] >= o.eye_high) continue;
    const auto first = [&](float at) { return static_cast<std::uint32_t>(std::max(0.0f, at / o.cell)); };
    const auto end = [&](float at) {
      return std::min(cells, static_cast<std::uint32_t>(std::ceil(at / o.cell)));
    };
    for (std::uint32_t y = first(b.low[1]); y < end(b.high[1]); ++y) {
      for (std::uint32_t x = first(b.low[0]); x < end(b.high[0]); ++x) taken[std::size_t{y} * cells + x] = 1;
    }
  }
  const auto at = [&](std::uint32_t i) { return static_cast<float>(i) * o.cell; };
  std::vector<Box> boxes;
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      if (taken[std::size_t{y} * cells + x] == 0) {
        boxes.push_back({{at(x), at(y), o.eye_low}, {at(x + 1), at(y + 1), o.eye_high}});
      }
    }
  }
  return boxes;
}

}  // namespace

SceneFile make_dense_city(const DenseCityOptions& o) {
  check(o);
  SceneFile city;
  const float side = static_cast<float>(o.size) * o.pitch + o.street;
  add_ground(city.scene, side, 10);
  ++city.scene.object_count;
  std::vector<Box> obstacles;
  for (std::uint32_t y = 0; y < o.size; ++y) {
    for (std::uint32_t x = 0; x < o.size; ++x) {
      Square square{city,
                    obstacles,
                    o,
                    Random(o.seed, std::uint64_t{y} * o.size + x),
                    static_cast<float>(x) * o.pitch,
                    static_cast<float>(y) * o.pitch};
      fill_square(square);
    }
  }
  city.cells.boxes = free_cells(o, side, obstacles);
  city.cells.eye_low = o.eye_low;
  city.cells.eye_high = o.eye_high;
  city.cells.neighbours = touching_boxes(city.cells.boxes);
  city.provenance = describe(o);
  city.seed = o.seed;
  return city;
}

std::string describe(const DenseCityOptions& o) {
  char text[400];
  std::snprintf(text, sizeof text,
                "dense city: size %u, pitch %g m, street %g m, sides %g-%g m, heights %g-%g m, step %g m, "
                "interiors %g, car "
                "parks %g, car sides %u, cells %g m, eyes %g-%g m, seed %llu",
                o.size, o.pitch, o.street, o.smallest_side, o.largest_side, o.lowest, o.highest, o.step,
                o.interiors, o.car_parks, o.car_sides, o.cell, o.eye_low, o.eye_high,
                static_cast<unsigned long long>(o.seed));
  return text;
}

}  // namespace vismat
