// ALGORITHM. A sight line that leaves a view cell crosses its border, and of all points on that line the one
// where it enters the cell sees farthest over a roof. So viewpoints are placed on the edges of cells, and
// what an edge sees counts for the cells on both its sides; a few stand inside cells, for scenes with
// overhangs, where that is no proof. From a viewpoint we look in a direction of the compass and climb: a
// level ray, then one that just clears the bounding box of what was hit, and so on until nothing higher is
// left. In a city that shows all there is to be seen in that direction, for one ray an object. Directions are
// aimed: just past both sides of every object known to be seen from here, and through it. Whatever turns up
// is aimed past in turn, as in guided visibility sampling [Wonka et al. 2006], since a sliver of something
// lies beside the silhouette of something nearer. In the next pass each edge also aims at what its cells saw
// through their other edges. Every (edge, pass) has its own random stream and reads only the pass before, so
// threads cannot change the result.
#include "visibility/rays/ray_sampling.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <glm/vec2.hpp>

#include "matrix/base/random.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

using Objects = std::vector<std::uint32_t>;  // ascending

/// Where viewpoints stand: at a corner of cells, along an edge, or anywhere in a cell. Corners that do not
/// differ are given twice or three times.
struct Site {
  std::array<glm::vec3, 3> corners;
  enum Kind { corner, edge, inside } kind;
  std::vector<std::uint32_t> cells = {};
  Objects seen = {};
  bool resting = false;
};

std::vector<Site> sites_of(const ViewCells& cells) {
  std::vector<Site> sites;
  using Point = std::array<float, 3>;
  std::map<std::array<Point, 2>, std::size_t> site_of_edge;
  const auto share = [&](const glm::vec3& a, const glm::vec3& b, Site::Kind kind, std::uint32_t cell) {
    std::array<Point, 2> ends = {Point{a.x, a.y, a.z}, Point{b.x, b.y, b.z}};
    std::sort(ends.begin(), ends.end());
    const auto [place, fresh] = site_of_edge.try_emplace(ends, sites.size());
    if (fresh) sites.push_back({{a, b, b}, kind});
    sites[place->second].cells.push_back(cell);
  };
  for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
    const glm::vec3* corner = &cells.corners[std::size_t{3} * cell];
    for (unsigned i = 0; i < 3; ++i) {
      share(corner[i], corner[i], Site::corner, cell);
      share(corner[i], corner[(i + 1) % 3], Site::edge, cell);
    }
    sites.push_back({{corner[0], corner[1], corner[2]}, Site::inside, {cell}});
  }
  return sites;
}

/// A direction of the compass, of length 1, and how steeply the next ray in it climbs: metres up per metre.
struct Direction {
  glm::vec2 heading;
  float slope = 0;
};

/// What one site sees during one pass.
class Look {
 public:
  Look(const Scene& scene, const std::vector<Box>& bounds, const RayCaster& caster)
      : scene_(scene), bounds_(bounds), caster_(caster), last_hit_(scene.object_count) {
    for (const Box& box : bounds) {
      lowest_top_ = std::min(lowest_top_, box.high[2]);
      highest_top_ = std::max(highest_top_, box.high[2]);
    }
  }

  /// Adds to what is seen. `aims`: objects to look through.
  void from(const glm::vec3& origin, const Objects& aims, std::uint32_t unaimed, Random& random) {
    origin_ = origin;
    ++viewpoint_;
    hit_here_.clear();
    const float turn = random.unit();
    for (std::uint32_t i = 0; i < unaimed; ++i) {
      const float angle =
          2 * std::numbers::pi_v<float> * (static_cast<float>(i) + turn) / static_cast<float>(unaimed);
      directions_.push_back({{std::cos(angle), std::sin(angle)}, 0});
    }
    for (const std::uint32_t object : aims) aim_at(bounds_[object], random);
    for (std::uint32_t i = 0; i < unaimed && lowest_top_ < origin.z; ++i) {
      const Box& box = bounds_[random.below(static_cast<std::uint32_t>(bounds_.size()))];
      if (box.high[2] < origin.z) aim_at(box, random);
    }
    climb();
    for (std::size_t next = 0; next < hit_here_.size();) {
      sort_by_angle(hit_here_.begin() + static_cast<std::ptrdiff_t>(next), hit_here_.end());
      for (; next < hit_here_.size(); ++next) {
        const auto [left, right] = sides(bounds_[hit_here_[next]]);
        const float top = bounds_[hit_here_[next]].high[2];
        head_for(left + glm::vec2(-left.y, left.x) * past, top);
        head_for(right + glm::vec2(right.y, -right.x) * past, top);
      }
      climb();
    }
  }
  const std::vector<std::uint32_t>& seen() const { return seen_; }
  std::uint64_t rays() const { return rays_; }

 private:
  /// Level, or down to that height if it lies below the eyes.
  void head_for(const glm::vec2& offset, float height) {
    const float length = std::hypot(offset.x, offset.y);
    if (length > 0) directions_.push_back({offset / length, std::min(0.0f, (height - origin_.z) / length)});
  }

  /// Through the middle diagonal of the box.
  void aim_at(const Box& box, Random& random) {
    const auto [left, right] = sides(box);
    head_for(right + (left - right) * random.unit(), box.high[2]);
  }

  /// Rays of one packet should cross the same parts of the scene.
  template <typename Iterator>
  void sort_by_angle(Iterator first, Iterator last) {
    by_angle_.clear();
    for (Iterator i = first; i != last; ++i) {
      const Box& box = bounds_[*i];
      by_angle_.emplace_back(
          std::atan2(box.low[1] + box.high[1] - 2 * origin_.y, box.low[0] + box.high[0] - 2 * origin_.x), *i);
    }
    std::sort(by_angle_.begin(), by_angle_.end());
    for (const auto& [angle, object] : by_angle_) *first++ = object;
  }

  /// The corners of the box that stand farthest left and right, seen from the viewpoint.
  std::pair<glm::vec2, glm::vec2> sides(const Box& box) const {
    const glm::vec2 here(origin_), low(box.low[0], box.low[1]), high(box.high[0], box.high[1]);
    glm::vec2 left = (low + high) * 0.5f - here, right = left;
    const auto cross = [](const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; };
    for (unsigned corner = 0; corner < 4; ++corner) {
      const glm::vec2 offset = glm::vec2(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y) - here;
      if (cross(left, offset) > 0) left = offset;
      if (cross(right, offset) < 0) right = offset;
    }
    return {left, right};
  }

  void climb() {
    while (!directions_.empty()) {
      std::size_t kept = 0;
      for (std::size_t first = 0; first < directions_.size(); first += RayCaster::width) {
        const auto count =
            static_cast<unsigned>(std::min<std::size_t>(RayCaster::width, directions_.size() - first));
        std::array<glm::vec3, RayCaster::width> rays{};
        for (unsigned i = 0; i < count; ++i) {
          const Direction& d = directions_[first + i];
          rays[i] = {d.heading.x, d.heading.y, d.slope};
        }
        rays_ += count;
        std::array<glm::vec3, RayCaster::width> origins;
        origins.fill(origin_);
        const auto hits = caster_.hits(origins, rays, count, true);
        for (unsigned i = 0; i < count; ++i) {
          for (const std::uint32_t triangle : caster_.passed(origin_, rays[i], hits[i].distance)) {
            take_note(scene_.object_of_triangle[triangle]);
          }
          if (hits[i].triangle == Hit::nothing) continue;
          const std::uint32_t object = scene_.object_of_triangle[hits[i].triangle];
          take_note(object);
          Direction& d = directions_[first + i];
          if (clear(bounds_[object], d)) directions_[kept++] = d;
        }
      }
      directions_.resize(kept);
    }
  }

  void take_note(std::uint32_t object) {
    const std::uint32_t before = std::exchange(last_hit_[object], viewpoint_);
    if (before == 0) seen_.push_back(object);
    if (before != viewpoint_) hit_here_.push_back(object);
  }

  /// Raises the slope until the ray clears the box; false if nothing can be seen above it.
  bool clear(const Box& box, Direction& d) const {
    float in = 0, out = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 2; ++axis) {
      if (d.heading[axis] == 0) continue;
      const float a = (box.low[axis] - origin_[axis]) / d.heading[axis];
      const float b = (box.high[axis] - origin_[axis]) / d.heading[axis];
      in = std::max(in, std::min(a, b));
      out = std::min(out, std::max(a, b));
    }
    const float rise = box.high[2] - origin_.z;
    const float slope = rise > 0 ? rise / in * (1 + past) + past : rise / out * (1 - past) + past;
    if (!(slope > d.slope && slope * out < highest_top_ - origin_.z))
      return false;  // in == 0: infinite, or NaN
    d.slope = slope;
    return true;
  }

  /// How far beside a silhouette we aim: 1 cm at 1 km, well above the precision of a float.
  static constexpr float past = 1e-5f;

  const Scene& scene_;
  const std::vector<Box>& bounds_;
  float lowest_top_ = std::numeric_limits<float>::infinity(), highest_top_ = -lowest_top_;
  const RayCaster& caster_;
  glm::vec3 origin_{};
  std::uint32_t viewpoint_ = 0;          // how many there have been
  std::vector<std::uint32_t> last_hit_;  // from which of them; 0: none
  std::vector<std::uint32_t> hit_here_, seen_;
  std::vector<std::pair<float, std::uint32_t>> by_angle_;
  std::vector<Direction> directions_;
  std::uint64_t rays_ = 0;
};

/// The k-th viewpoint of a site; along an edge they lie ever denser and evenly spread.
glm::vec3 viewpoint(const Site& site, const ViewCells& cells, std::uint32_t k, float turn, Random& random) {
  const auto& [a, b, c] = site.corners;
  float u = static_cast<float>(k) * 0.6180339887f + turn, v = 0;
  u -= std::floor(u);
  if (site.kind == Site::inside) {
    u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
  }
  glm::vec3 point = a + (b - a) * u + (c - a) * v;
  const std::array<float, 3> heights = {cells.eye_high, cells.eye_low,
                                        random.between(cells.eye_low, cells.eye_high)};
  point.z += heights[k % 3];
  return point;
}

Objects united(const Objects& a, const Objects& b) {
  Objects both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

std::vector<Objects> seen_by_cells(const std::vector<Site>& sites, std::uint32_t count) {
  std::vector<Objects> seen(count);
  for (const Site& site : sites) {
    for (const std::uint32_t cell : site.cells) seen[cell] = united(seen[cell], site.seen);
  }
  return seen;
}

}  // namespace

SeenByRays see_by_rays(const Scene& scene, const ViewCells& cells, const RaySamplingOptions& options,
                       const Progress& progress) {
  if (options.passes == 0 || options.origins == 0 || options.directions == 0) {
    throw std::invalid_argument("ray sampling: passes, origins and directions must be at least 1");
  }
  if (!cells.boxes.empty()) {
    throw std::invalid_argument("ray sampling: needs view cells that are triangles of the ground, not boxes");
  }
  if (!(options.enough_yield >= 0))
    throw std::invalid_argument("ray sampling: the yield must not be below 0");
  const RayCaster caster(scene);
  const std::vector<Box> bounds = object_bounds(scene);

  std::vector<Site> sites = sites_of(cells);
  std::vector<Objects> seen_by_cell(cells.count());
  SeenByRays result;
  result.last_yield.assign(cells.count(), 0);
  std::atomic<std::uint64_t> rays = 0;
  for (std::uint32_t pass = 0; pass < options.passes; ++pass) {
    parallel_for(
        sites.size(), options.threads,
        [&](std::uint64_t i) {
          Site& site = sites[i];
          if (site.resting) return;
          const float turn = Random(options.seed, i).unit();
          Random random(options.seed, i + sites.size() * (pass + 1));
          Look look(scene, bounds, caster);
          Objects aims;
          for (const std::uint32_t cell : site.cells) aims = united(aims, seen_by_cell[cell]);
          const std::uint32_t origins = site.kind == Site::edge ? options.origins : 1;
          for (std::uint32_t k = 0; k < origins; ++k) {
            look.from(viewpoint(site, cells, pass * origins + k, turn, random), aims,
                      pass == 0 ? options.directions : 16, random);
          }
          Objects found = look.seen();
          std::sort(found.begin(), found.end());
          site.seen = united(site.seen, found);
          rays += look.rays();
        },
        [&](std::uint64_t done, std::uint64_t total) {
          if (progress) progress(pass * total + done, options.passes * total);
        });
    std::vector<Objects> now = seen_by_cells(sites, cells.count());
    for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
      result.last_yield[cell] = static_cast<std::uint32_t>(now[cell].size() - seen_by_cell[cell].size());
    }
    seen_by_cell = std::move(now);
    bool all_rest = true;
    for (Site& site : sites) {
      site.resting = true;
      for (const std::uint32_t cell : site.cells) {
        const auto gained = static_cast<float>(result.last_yield[cell]);
        if (gained > options.enough_yield * static_cast<float>(seen_by_cell[cell].size()))
          site.resting = false;
      }
      all_rest = all_rest && site.resting;
    }
    if (all_rest) {
      const std::uint64_t all = options.passes * sites.size();
      if (progress && pass + 1 < options.passes) progress(all, all);
      break;
    }
  }
  result.rays = rays;
  result.objects = VisibilityMatrix::from_rows(seen_by_cell, scene.object_count);
  return result;
}

std::string describe(const RaySamplingOptions& o) {
  char text[160];
  std::snprintf(text, sizeof text,
                "rays: %u viewpoints, %u unaimed directions, at most %u passes, enough %g, seed %llu",
                o.origins, o.directions, o.passes, o.enough_yield, static_cast<unsigned long long>(o.seed));
  return text;
}

}  // namespace vismat
