// ALGORITHM. Bays side by side, an aisle along two sides of each. A bay gets a tank, a row of vessels, or a steel frame with
// gratings and stairs. Pipes then take what is left of a lattice of nodes 0.8 m apart: a route starts anywhere, runs
// straight for a while, turns where it likes or must, and ends where it is shut in. A piece of pipe stays within the cubes
// round its nodes, so no two routes meet. Plants are the hard case: thin things at all angles of the compass, each of
// which hides little, while all of them together hide much.
#include "visibility/generators/plant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/vec2.hpp>
#include <span>
#include <stdexcept>

#include "matrix/base/random.h"
#include "visibility/cells/grid_cells.h"
#include "visibility/generators/solids.h"

namespace vismat {
namespace {

constexpr float spacing = 0.8f;  // of nodes
constexpr int aisle = 3;         // nodes wide
constexpr float plant_storey = 4 * spacing;
const glm::vec3 upward(0, 0, 1);

void check(const PlantOptions& o) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("plant: " + what); };
  if (o.size < 1 || o.size > 64) refuse("size " + std::to_string(o.size) + " is not from 1 to 64");
  if (!(o.bay >= 8 && o.bay <= 100)) refuse("a bay must have 8 to 100 m");
  if (!(o.height >= 4 && o.height <= 100)) refuse("the height must be 4 to 100 m");
  if (!(o.pipes >= 0 && o.pipes <= 1)) refuse("the pipes' share must lie between 0 and 1");
  if (o.pipe_sides < 3 || o.pipe_sides > 256) refuse("a pipe has 3 to 256 sides");
  if (!(o.cell >= 0.5f && o.cell <= 1e3f)) refuse("a cell's side must be 0.5 to 1000 m");
}

class Plant {
 public:
  explicit Plant(const PlantOptions& options)
      : o_(options), bay_(static_cast<int>(std::floor(o_.bay / spacing + 1e-3f))) {
    count_ = {static_cast<int>(o_.size) * bay_ + aisle, 0,
              static_cast<int>(std::floor(o_.height / spacing + 1e-3f))};
    count_[1] = count_[0];
    taken_.resize(std::size_t(count_[0]) * count_[1] * count_[2]);
    add_ground(scene_, static_cast<float>(count_[0]) * spacing, 10);
    ++scene_.object_count;
    for (std::uint32_t bay = 0; bay < o_.size * o_.size; ++bay) {
      Random random(o_.seed, bay + 1);
      const auto corner = [&](std::uint32_t at) {
        return static_cast<float>(int(at) * bay_ + aisle + 1) * spacing;
      };
      const float side = static_cast<float>(bay_ - aisle - 2) * spacing;
      const glm::vec2 low(corner(bay % o_.size), corner(bay / o_.size));
      const std::uint32_t kind = random.below(4);
      if (kind == 0) add_tank(random, low + side / 2, side);
      if (kind == 1 || kind == 2) add_vessels(random, low, side);
      if (kind == 3) add_frame(random, low, side);
      keep_aisles_free(bay);
    }
    add_pipes();
  }
  Scene scene() && { return std::move(scene_); }

 private:
  using Node = std::array<int, 3>;

  bool inside(const Node& n) const {
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (n[axis] < 0 || n[axis] >= count_[axis]) return false;
    }
    return true;
  }
  std::uint8_t& taken(const Node& n) {
    return taken_[(std::size_t(n[2]) * count_[1] + n[1]) * count_[0] + n[0]];
  }
  void reserve(const Box& b) {
    Node first, last;
    for (unsigned axis = 0; axis < 3; ++axis) {
      first[axis] = std::clamp(static_cast<int>(std::floor(b.low[axis] / spacing + 1e-3f)), 0, count_[axis]);
      last[axis] = std::clamp(static_cast<int>(std::ceil(b.high[axis] / spacing - 1e-3f)), 0, count_[axis]);
    }
    for (int z = first[2]; z < last[2]; ++z) {
      for (int y = first[1]; y < last[1]; ++y) {
        for (int x = first[0]; x < last[0]; ++x) taken({x, y, z}) = 1;
      }
    }
  }
  void keep_aisles_free(std::uint32_t bay) {
    const auto at = [&](std::uint32_t i) { return static_cast<float>(int(i) * bay_) * spacing; };
    const float x = at(bay % o_.size), y = at(bay / o_.size), length = at(1) + aisle * spacing;
    reserve({{x, y, 0}, {x + length, y + aisle * spacing, plant_storey}});
    reserve({{x, y, 0}, {x + aisle * spacing, y + length, plant_storey}});
  }
  void finish_object(const Box& bounds) {
    reserve(bounds);
    ++scene_.object_count;
  }

  void add_tank(Random& random, const glm::vec2& middle, float side) {
    const float radius = side * random.between(0.3f, 0.45f), wall = random.between(3.f, o_.height - 1),
                dome = radius * 0.3f;
    std::vector<Turn> profile = {{0, radius}};
    for (int k = 0; k < 6; ++k) {
      const float angle = static_cast<float>(k) * 0.2618f;
      profile.push_back({wall + dome * std::sin(angle), radius * std::cos(angle)});
    }
    add_turned(scene_, {middle, 0}, upward, 0, profile, wall + dome, 40);
    finish_object(
        {{middle.x - radius, middle.y - radius, 0}, {middle.x + radius, middle.y + radius, wall + dome}});
  }

  /// Lying side by side along y, each on two saddles.
  void add_vessels(Random& random, const glm::vec2& low, float side) {
    const auto count = std::max(1u, static_cast<std::uint32_t>(side / 3));
    const float width = side / static_cast<float>(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float radius = random.between(0.5f, std::min(1.2f, width / 2 - 0.1f)),
                  bottom = random.between(0.6f, 1.2f);
      const float x = low.x + width * (static_cast<float>(i) + 0.5f), dome = radius * 0.5f, from = dome,
                  to = side - dome;
      std::vector<Turn> profile;
      for (int k = 1; k <= 5; ++k) {
        const float angle = static_cast<float>(k) * 0.31416f;
        profile.push_back({from - dome * std::cos(angle), radius * std::sin(angle)});
      }
      for (int k = 5; k >= 1; --k) {
        const float angle = static_cast<float>(k) * 0.31416f;
        profile.push_back({to + dome * std::cos(angle), radius * std::sin(angle)});
      }
      add_turned(scene_, {x, low.y, bottom + radius}, {0, 1, 0}, 0, profile, side, 24);
      finish_object({{x - radius, low.y, bottom}, {x + radius, low.y + side, bottom + 2 * radius}});
      for (const float along : {0.25f, 0.75f}) {
        const float y = low.y + side * along;
        const Box saddle = {{x - radius / 2, y - 0.15f, 0}, {x + radius / 2, y + 0.15f, bottom}};
        add_box(scene_, saddle, 10);
        finish_object(saddle);
      }
    }
  }

  /// An I along an axis.
  void add_beam(const Box& b, unsigned axis) {
    const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto part = [&](unsigned across, float share) {
      return b.low[across] + (b.high[across] - b.low[across]) * share;
    };
    std::array<std::vector<float>, 3> cuts;
    cuts[axis] = {b.low[axis], b.high[axis]};
    cuts[u] = {b.low[u], part(u, 0.4f), part(u, 0.6f), b.high[u]};
    cuts[v] = {b.low[v], part(v, 0.15f), part(v, 0.85f), b.high[v]};
    Lattice beam(cuts, 100);
    beam.set(b, true);
    Box notch = b;
    notch.low[v] = cuts[v][1];
    notch.high[v] = cuts[v][2];
    notch.high[u] = cuts[u][1];
    beam.set(notch, false);
    notch.low[u] = cuts[u][2];
    notch.high[u] = b.high[u];
    beam.set(notch, false);
    beam.add_to(scene_);
    finish_object(b);
  }

  void add_grating(const Box& b) {
    constexpr int bars = 5;
    constexpr float width = 0.06f;
    std::array<std::vector<float>, 3> cuts;
    cuts[2] = {b.low[2], b.high[2]};
    for (unsigned axis = 0; axis < 2; ++axis) {
      for (int i = 0; i < bars; ++i) {
        const float at =
            b.low[axis] + (b.high[axis] - b.low[axis] - width) * static_cast<float>(i) / (bars - 1);
        cuts[axis].insert(cuts[axis].end(), {at, at + width});
      }
    }
    Lattice grating(cuts, 100);
    for (int y = 0; y < grating.cells(1); ++y) {
      for (int x = 0; x < grating.cells(0); ++x) {
        if (x % 2 == 0 || y % 2 == 0) grating.set_cell({x, y, 0}, true);
      }
    }
    grating.add_to(scene_);
    finish_object(b);
  }

  void add_stairs(const glm::vec3& foot) {
    constexpr int steps = 16;
    constexpr float rise = plant_storey / steps, tread = 0.28f, width = 0.9f;
    std::array<std::vector<float>, 3> cuts;
    cuts[1] = {foot.y, foot.y + width};
    for (int i = 0; i <= steps; ++i) {
      cuts[0].push_back(foot.x + tread * static_cast<float>(i));
      cuts[2].push_back(foot.z + rise * static_cast<float>(i));
    }
    Lattice stairs(cuts, 100);
    for (int i = 0; i < steps; ++i) {
      for (int k = std::max(0, i - 1); k <= i; ++k) stairs.set_cell({i, 0, k}, true);
    }
    stairs.add_to(scene_);
    finish_object(
        {{foot.x, foot.y, foot.z}, {foot.x + tread * steps, foot.y + width, foot.z + plant_storey}});
  }

  /// Columns three by three, beams between them at each storey, panels of grating on these.
  void add_frame(Random& random, const glm::vec2& low, float side) {
    constexpr float thick = 0.3f, plate = 0.04f;
    const int storeys = std::max(1, static_cast<int>(o_.height / plant_storey + 1e-3f));
    const float span = (side - thick) / 2;
    const auto line = [&](unsigned axis, int i) {
      return low[static_cast<int>(axis)] + span * static_cast<float>(i);
    };
    for (int i = 0; i < 9; ++i) {
      const float x = line(0, i % 3), y = line(1, i / 3);
      add_beam({{x, y, 0}, {x + thick, y + thick, static_cast<float>(storeys) * plant_storey}}, 2);
    }
    for (int floor = 1; floor <= storeys; ++floor) {
      const float z = static_cast<float>(floor) * plant_storey;
      for (unsigned axis = 0; axis < 2; ++axis) {
        for (int i = 0; i < 6; ++i) {
          Box b;
          b.low[axis] = line(axis, i % 2) + thick;
          b.high[axis] = line(axis, i % 2 + 1);
          b.low[1 - axis] = line(1 - axis, i / 2);
          b.high[1 - axis] = b.low[1 - axis] + thick;
          b.low[2] = z - thick;
          b.high[2] = z;
          add_beam(b, axis);
        }
      }
      const bool stairs = span - thick >= 4.6f;
      if (stairs) add_stairs({line(0, 0) + thick, line(1, 0) + thick + 0.2f, z - plant_storey});
      const float panel = (span - thick) / 3;
      for (int i = 0; i < 36; ++i) {
        const int square = i / 9, column = i % 3, row = i % 9 / 3;
        if (stairs && square == 0 && row == 0) continue;
        const float x = line(0, square % 2) + thick + panel * static_cast<float>(column);
        const float y = line(1, square / 2) + thick + panel * static_cast<float>(row);
        add_grating({{x, y, z}, {x + panel, y + panel, z + plate}});
        if (floor < storeys && random.below(6) == 0) {
          const float radius = panel * random.between(0.15f, 0.4f), high = random.between(0.8f, 2.f);
          const glm::vec3 base(x + panel / 2, y + panel / 2, z + plate);
          const std::array<Turn, 4> drum = {
              {{0, radius * 0.9f}, {0.1f, radius}, {high - 0.1f, radius}, {high, radius * 0.7f}}};
          add_turned(scene_, base, upward, 0, drum, high, 16);
          finish_object({{base.x - radius, base.y - radius, base.z},
                         {base.x + radius, base.y + radius, base.z + high}});
        }
      }
    }
  }

  static Node step(const Node& n, unsigned direction, int by = 1) {
    Node next = n;
    next[direction / 2] += direction % 2 == 0 ? by : -by;
    return next;
  }
  static glm::vec3 vector(unsigned direction) {
    glm::vec3 v(0);
    v[static_cast<int>(direction / 2)] = direction % 2 == 0 ? 1.f : -1.f;
    return v;
  }
  static glm::vec3 middle(const Node& n) {
    return (glm::vec3(static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])) + 0.5f) *
           spacing;
  }

  void add_pipes() {
    Random random(o_.seed, 0);
    const std::uint64_t most =
        static_cast<std::uint64_t>(double{o_.pipes} * static_cast<double>(taken_.size()));
    std::uint64_t used = 0;
    for (std::size_t tries = taken_.size() / 10; used < most && tries > 0; --tries) {
      Node at;
      for (unsigned axis = 0; axis < 3; ++axis)
        at[axis] = static_cast<int>(random.below(static_cast<std::uint32_t>(count_[axis])));
      if (taken(at)) continue;
      taken(at) = 1;
      std::vector<Node> route = {at};
      std::vector<unsigned> out = {random.below(6)};  // the direction in which the route leaves each node
      for (std::uint32_t bends = random.below(10), left = 3 + random.below(20);; --left) {
        unsigned direction = out.back();
        const auto open = [&](unsigned d) { return inside(step(at, d)) && !taken(step(at, d)); };
        if (left == 0 || !open(direction)) {
          if (bends-- == 0) break;
          const unsigned first = random.below(6);
          unsigned turn = 0;
          while (turn < 6 && ((first + turn) % 6 / 2 == direction / 2 || !open((first + turn) % 6))) ++turn;
          if (turn == 6) break;
          direction = (first + turn) % 6;
          left = 3 + random.below(20);
        }
        out.back() = direction;
        at = step(at, direction);
        taken(at) = 1;
        route.push_back(at);
        out.push_back(direction);
      }
      used += route.size();
      if (route.size() > 1) add_route(random, route, out);
    }
  }

  void add_route(Random& random, const std::vector<Node>& route, const std::vector<unsigned>& out) {
    const float radius = 0.06f + 0.24f * random.unit() * random.unit();
    constexpr std::size_t longest = 8;  // nodes; 6.4 m is what comes off a lorry
    for (std::size_t i = 0; i < route.size();) {
      const unsigned in = i == 0 ? out[0] : out[i - 1];
      if (in != out[i]) {
        add_elbow(middle(route[i]), vector(in), vector(out[i]), radius);
        ++i;
        continue;
      }
      std::size_t end = i + 1;
      const bool valve = random.below(16) == 0;
      while (!valve && end < route.size() && end - i < longest && out[end] == in) ++end;
      const float length = spacing * static_cast<float>(end - i);
      const glm::vec3 start = middle(route[i]) - vector(in) * (spacing / 2);
      if (valve) {
        const std::array<Turn, 6> body = {{{0, radius},
                                           {0.2f, radius},
                                           {0.25f, radius + 0.08f},
                                           {0.55f, radius + 0.08f},
                                           {0.6f, radius},
                                           {length, radius}}};
        add_turned(scene_, start, vector(in), 0, body, length, o_.pipe_sides);
      } else {
        const std::array<Turn, 2> body = {{{0, radius}, {length, radius}}};
        add_turned(scene_, start, vector(in), 0, body, length, o_.pipe_sides);
      }
      ++scene_.object_count;
      i = end;
    }
  }

  /// A quarter of a torus that fills no more than the node's cube.
  void add_elbow(const glm::vec3& at, const glm::vec3& in, const glm::vec3& out, float radius) {
    constexpr int parts = 4;
    const glm::vec3 hinge = at + (out - in) * (spacing / 2);
    std::vector<std::vector<glm::vec3>> rings;
    for (int k = 0; k <= parts; ++k) {
      const float angle = 1.5707964f * static_cast<float>(k) / parts;
      const glm::vec3 outward = in * std::sin(angle) - out * std::cos(angle);
      const glm::vec3 along = in * std::cos(angle) + out * std::sin(angle);
      rings.push_back(circle(hinge + outward * (spacing / 2), along, outward, radius, o_.pipe_sides));
    }
    add_loft(scene_, at - in * (spacing / 2), rings, at + out * (spacing / 2));
    ++scene_.object_count;
  }

  PlantOptions o_;
  int bay_;  // nodes along its side
  Node count_{};
  std::vector<std::uint8_t> taken_;
  Scene scene_;
};

}  // namespace

SceneFile make_plant(const PlantOptions& options, unsigned threads) {
  check(options);
  SceneFile plant;
  plant.scene = Plant(options).scene();
  GridCellsOptions cells;
  cells.size = glm::vec3(options.cell);
  cells.threads = threads;
  plant.cells = make_grid_cells(plant.scene, cells);
  plant.provenance = describe(options);
  plant.seed = options.seed;
  return plant;
}

std::string describe(const PlantOptions& o) {
  char text[256];
  std::snprintf(text, sizeof text,
                "plant: size %u, bays %g m, height %g m, pipes %g, pipe sides %u, cells %g m, seed %llu",
                o.size, o.bay, o.height, o.pipes, o.pipe_sides, o.cell,
                static_cast<unsigned long long>(o.seed));
  return text;
}

}  // namespace vismat
