// ALGORITHM. A sight line that leaves the cell crosses its surface, and the rest of it is a sight line too; so the lines to
// look at join a triangle of the cell's surface to one of the object. A pair of triangles is closed if one occluder hides the
// one from the other (hides() has the proof that nine segments are enough), ends the search if the segment between two of its
// points is free, and is split along the longer of all edges otherwise, breadth first. This replaces the polytopes in
// Pluecker space of Nirenstein 2002 and Haumont 2005: no algebra, only signs of determinants. The price is the answer
// "undecided": behind two occluders that share an edge, the pairs with lines through that edge are split for ever.
#include "visibility/exact/line_space.h"

#include <algorithm>
#include <deque>
#include <glm/geometric.hpp>
#include <memory>

#include "visibility/geometry/point_bounds.h"

namespace vismat {
namespace {

// No value where doubles do not hold it.
std::optional<glm::dvec3> midpoint(const glm::dvec3& a, const glm::dvec3& b) {
  glm::dvec3 middle;
  for (int k = 0; k < 3; ++k) {
    const double sum = a[k] + b[k], of_b = sum - a[k];
    if ((a[k] - (sum - of_b)) + (b[k] - of_b) != 0) return std::nullopt;  // what the sum lost
    middle[k] = sum / 2;
  }
  return middle;
}

struct Wall {
  const Occluder* occluder;
  Bounds bounds;
};
struct Curtain {
  Triangle triangle;
  Bounds bounds;
};
// What may stand between the triangles of a pair; its parts share it while it is short anyway.
struct Between {
  std::vector<Wall> walls;
  std::vector<Curtain> curtains;
};
struct Pair {
  Triangle from, to;
  std::shared_ptr<const Between> between;
};

std::size_t longest_edge(const Triangle& t) {
  std::size_t longest = 0;
  double most = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = glm::distance(t[i], t[(i + 1) % 3]);
    if (length > most) most = length, longest = i;
  }
  return longest;
}
double length_of(const Triangle& t, std::size_t edge) {
  return glm::distance(t[edge], t[(edge + 1) % 3]);
}

std::optional<std::array<Triangle, 2>> halves(const Triangle& t, std::size_t edge) {
  const glm::dvec3 &a = t[edge], &b = t[(edge + 1) % 3], &c = t[(edge + 2) % 3];
  const auto middle = midpoint(a, b);
  if (!middle) return std::nullopt;
  return std::array<Triangle, 2>{Triangle{a, *middle, c}, Triangle{*middle, b, c}};
}

// Halfway from the middle of the longest edge to the third corner.
std::optional<glm::dvec3> inner_point(const Triangle& t) {
  const std::size_t edge = longest_edge(t);
  const auto middle = midpoint(t[edge], t[(edge + 1) % 3]);
  return middle ? midpoint(*middle, t[(edge + 2) % 3]) : std::nullopt;
}

bool closed_by(const Occluder& occluder, const Triangle& from, const Triangle& to) {
  if (!hides(occluder.shape, from, to)) return false;
  if (occluder.flat) return true;
  // From outside a segment that meets the solid crosses its surface. From a point on it, only if it comes out again.
  return beyond_a_face(occluder.shape, from, true) ||
         (beyond_a_face(occluder.shape, from, false) && beyond_a_face(occluder.shape, to, true));
}

}  // namespace

LineSpaceAnswer look_in_line_space(const Scene& scene, std::span<const Occluder> occluders,
                                   const Convex& cell, std::uint32_t object, std::uint64_t most_pieces) {
  auto all = std::make_shared<Between>();
  for (const Occluder& occluder : occluders) {
    if (occluder.object != object && blocks_from(occluder, cell))
      all->walls.push_back({&occluder, bounds_of(occluder.shape.vertices)});
  }
  std::vector<Triangle> targets;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const std::uint32_t owner = scene.object_of_triangle[t];
    const Triangle triangle = corners_of<glm::dvec3>(scene, t);
    if (owner == object) {
      targets.push_back(triangle);
    } else if (scene.see_through.empty() || !scene.see_through[owner]) {
      all->curtains.push_back({triangle, bounds_of(triangle)});
    }
  }
  LineSpaceAnswer answer;
  for (const Triangle& target : targets) {
    if (meets(target, cell)) {
      answer.visibility = Visibility::visible;
      return answer;
    }
  }

  std::deque<Pair> open;
  for (const Triangle& from : triangles_of(cell)) {
    for (const Triangle& to : targets) open.push_back({from, to, all});
  }
  bool stuck = false;
  while (!open.empty() && answer.pieces < most_pieces) {
    Pair pair = std::move(open.front());
    open.pop_front();
    ++answer.pieces;
    const Bounds around =
        bounds_of(std::array{pair.from[0], pair.from[1], pair.from[2], pair.to[0], pair.to[1], pair.to[2]});
    const auto off = [&](const auto& what) { return !meet(what.bounds, around); };
    if (std::any_of(pair.between->walls.begin(), pair.between->walls.end(), off) ||
        std::any_of(pair.between->curtains.begin(), pair.between->curtains.end(), off)) {
      auto fewer = std::make_shared<Between>(*pair.between);
      std::erase_if(fewer->walls, off);
      std::erase_if(fewer->curtains, off);
      pair.between = std::move(fewer);
    }
    const auto from = inner_point(pair.from), to = inner_point(pair.to);
    if (from && to &&
        std::none_of(pair.between->curtains.begin(), pair.between->curtains.end(),
                     [&](const Curtain& curtain) { return crosses(*from, *to, curtain.triangle); })) {
      answer.visibility = Visibility::visible;
      answer.sight_line = std::array{*from, *to};
      return answer;
    }
    if (std::any_of(pair.between->walls.begin(), pair.between->walls.end(),
                    [&](const Wall& wall) { return closed_by(*wall.occluder, pair.from, pair.to); })) {
      continue;
    }
    const std::size_t edge_from = longest_edge(pair.from), edge_to = longest_edge(pair.to);
    const bool split_from = length_of(pair.from, edge_from) > length_of(pair.to, edge_to);
    const auto parts = split_from ? halves(pair.from, edge_from) : halves(pair.to, edge_to);
    if (!parts) {
      stuck = true;
      continue;
    }
    for (const Triangle& part : *parts) {
      open.push_back(split_from ? Pair{part, pair.to, pair.between} : Pair{pair.from, part, pair.between});
    }
  }
  if (open.empty() && !stuck) answer.visibility = Visibility::hidden;
  return answer;
}

}  // namespace vismat
