// The producer "climbing": rays that search the skyline of a city of boxes.
//
// ALGORITHM. A sight line that leaves a view cell crosses its surface, and of all points on that line the one
// where it enters the cell sees farthest over a roof. So viewpoints are placed on the edges of cells, and
// what an edge sees counts for the cells on both its sides; a few stand inside cells, for scenes with
// overhangs, where that is no proof. From a viewpoint we look in a direction of the compass and climb: a
// level ray, then one that just clears the bounding box of what was hit, and so on until nothing higher is
// left. In a city that shows all there is to be seen in that direction, for one ray for each object. Directions are
// aimed: just past both sides of every object known to be seen from here, and through it. Whatever turns up
// is aimed past in turn, as in guided visibility sampling [Wonka et al. 2006], since a sliver of something
// lies beside the silhouette of something nearer. In the next pass each edge also aims at what its cells saw
// through their other edges. Every (edge, pass) has its own random stream and reads only the pass before, so
// threads cannot change the result.

#include <algorithm>
#include <array>
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
#include "visibility/producers/producers.h"
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

struct Options {
  std::uint32_t passes = 0;      // at most; see enough for the usual end
  std::uint32_t viewpoints = 0;  // an edge of a cell and pass; a corner and a cell itself add one
  std::uint32_t directions = 0;  // unaimed ones all around, a viewpoint of the first pass
  float enough = 0;              // a cell rests once a pass adds less than this part of what it sees
  std::uint64_t seed = 0;
};

Options with_defaults(const ProducerOptions& o) {
  return {o.passes.value_or(4), o.viewpoints.value_or(12), o.directions.value_or(128),
          static_cast<float>(o.enough.value_or(0.01)), o.seed.value_or(1)};
}

/// What is known so far, of sites and of cells, and what a pass makes of it.
class Passes {
 public:
  Passes(const Scene& scene, const ViewCells& cells, const Options& options, JobRunner& runner)
      : scene_(scene),
        cells_(cells),
        options_(options),
        runner_(runner),
        caster_(scene),
        bounds_(object_bounds(scene)),
        sites_(sites_of(cells)),
        seen_by_cell_(cells.count()) {}

  /// False once all sites rest.
  bool run(std::uint32_t pass, const Progress& progress) {
    constexpr std::uint64_t sites_a_piece = 16;
    std::vector<std::uint64_t> awake;
    for (std::uint64_t i = 0; i < sites_.size(); ++i) {
      if (!sites_[i].resting) awake.push_back(i);
    }
    const auto sites_of_piece = [&](std::uint64_t piece) {
      const std::uint64_t first = piece * sites_a_piece;
      return std::span(awake).subspan(first, std::min(sites_a_piece, awake.size() - first));
    };
    const auto pieces = runner_.run(
        "pass " + std::to_string(pass), (awake.size() + sites_a_piece - 1) / sites_a_piece,
        [&](std::uint64_t piece) {
          JobRunner::Piece bytes;
          std::uint64_t cast = 0;
          for (const std::uint64_t site : sites_of_piece(piece)) {
            put<std::uint32_t>(bytes, newly_seen(site, pass, cast));
          }
          put<std::uint64_t>(bytes, std::span(&cast, 1));
          return bytes;
        },
        progress);
    for (std::uint64_t piece = 0; piece < pieces.size(); ++piece) {
      std::span<const std::byte> bytes = pieces[piece];
      for (const std::uint64_t site : sites_of_piece(piece)) {
        sites_[site].seen = united(sites_[site].seen, take<std::uint32_t>(bytes));
      }
      cast_ += take<std::uint64_t>(bytes).at(0);
    }
    return rest();
  }

  Sight result() const {
    Sight sight;
    sight.seen = VisibilityMatrix::from_rows(seen_by_cell_, scene_.object_count);
    sight.rays = cast_;
    sight.last_found = last_found_;
    return sight;
  }

 private:
  /// What a pass shows from there that no pass before has.
  Objects newly_seen(std::uint64_t i, std::uint32_t pass, std::uint64_t& cast) const {
    const Site& site = sites_[i];
    const float turn = Random(options_.seed, i).unit();
    Random random(options_.seed, i + sites_.size() * (pass + 1));
    Look look(scene_, bounds_, caster_);
    Objects aims;
    for (const std::uint32_t cell : site.cells) aims = united(aims, seen_by_cell_[cell]);
    const std::uint32_t viewpoints = site.kind == Site::edge ? options_.viewpoints : 1;
    for (std::uint32_t k = 0; k < viewpoints; ++k) {
      look.from(viewpoint(site, cells_, pass * viewpoints + k, turn, random), aims,
                pass == 0 ? options_.directions : 16, random);
    }
    cast += look.rays();
    Objects seen = look.seen(), fresh;
    std::sort(seen.begin(), seen.end());
    std::set_difference(seen.begin(), seen.end(), site.seen.begin(), site.seen.end(),
                        std::back_inserter(fresh));
    return fresh;
  }

  /// Gives cells what their sites see, and rest to the sites whose cells gained little. Whether any goes on.
  bool rest() {
    std::vector<Objects> now = seen_by_cells(sites_, cells_.count());
    std::vector<bool> gains(cells_.count());
    last_found_ = 0;
    for (std::uint32_t cell = 0; cell < cells_.count(); ++cell) {
      const std::size_t gained = now[cell].size() - seen_by_cell_[cell].size();
      last_found_ += gained;
      gains[cell] = static_cast<float>(gained) > options_.enough * static_cast<float>(now[cell].size());
    }
    seen_by_cell_ = std::move(now);
    bool any = false;
    for (Site& site : sites_) {
      site.resting =
          std::none_of(site.cells.begin(), site.cells.end(), [&](std::uint32_t cell) { return gains[cell]; });
      any = any || !site.resting;
    }
    return any;
  }

  const Scene& scene_;
  const ViewCells& cells_;
  const Options& options_;
  JobRunner& runner_;
  RayCaster caster_;
  std::vector<Box> bounds_;
  std::vector<Site> sites_;
  std::vector<Objects> seen_by_cell_;
  std::uint64_t cast_ = 0, last_found_ = 0;
};

/// Every entry is backed by a ray from a point of the cell at eye height, so nothing is invented; slivers may be missed
/// (docs/artificial.md measures how many). Time is that of the rays, a few million a second and core; memory one list of
/// objects for each edge, corner and cell. Coordinates must be finite.
Sight see(const Scene& scene, const ViewCells& cells, const ProducerOptions& given, JobRunner& runner,
          const Stages& stages) {
  const Options options = with_defaults(given);
  if (options.passes == 0 || options.viewpoints == 0 || options.directions == 0) {
    throw std::invalid_argument("climbing: passes, viewpoints and directions must be at least 1");
  }
  if (!cells.boxes.empty()) {
    throw std::invalid_argument("climbing: needs view cells that are triangles of the ground, not boxes");
  }
  if (!(options.enough >= 0)) throw std::invalid_argument("climbing: enough must not be below 0");
  Passes passes(scene, cells, options, runner);
  ProgressOfRounds progress(begin_stage(stages, "looking around"), options.passes);
  std::uint32_t pass = 0;
  while (pass < options.passes && passes.run(pass, progress.round(pass))) ++pass;
  progress.end();
  return passes.result();
}

std::string describe(const ProducerOptions& given) {
  const Options o = with_defaults(given);
  char text[160];
  std::snprintf(text, sizeof text,
                "rays: %u viewpoints, %u unaimed directions, at most %u passes, enough %g, seed %llu",
                o.viewpoints, o.directions, o.passes, static_cast<double>(o.enough),
                static_cast<unsigned long long>(o.seed));
  return text;
}

}  // namespace

Producer climbing_producer() {
  using O = ProducerOptions;
  Producer producer;
  producer.name = "climbing";
  producer.idea =
      "rays that search the skyline, each steeper than the one before, for cities of boxes whose view "
      "cells are triangles of the ground";
  producer.guarantee = Guarantee::aggressive;
  producer.options = {&O::directions, &O::viewpoints, &O::passes, &O::enough, &O::seed};
  producer.describe = describe;
  producer.see = see;
  return producer;
}

}  // namespace vismat
