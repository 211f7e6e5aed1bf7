// A path is made of legs, between which it jumps. A leg is a line of bends: middles of cells where it begins, ends and has reached a
// goal, and the crossings between. As cells are convex, whatever lies between two bends is in the cell that both are of.
#include "runtime/camera/path_makers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <iterator>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "runtime/camera/passages.h"
#include "runtime/level_walk.h"
#include "visibility/geometry/convex.h"
#include "visibility/geometry/point_bounds.h"

namespace vismat {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double between_poses = 0.1, looks_ahead = 1, between_jumps = 5;  // seconds
constexpr double glance = 60 * degree, glance_seconds = 6;
constexpr double steepest = 45 * degree, roof_pitch = 20 * degree;
constexpr double shortest = 1e-7;  // metres between bends
constexpr std::size_t most_poses = 1'000'000;

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("camera path: " + why);
}

glm::dvec3 middle_of_cell(const ViewCells& cells, std::uint32_t cell) {
  return middle_of(convex_of(cells, cell).vertices);
}

struct Bend {
  glm::dvec3 at;
  bool jump = false;            // one comes here from the last bend at once
  std::uint32_t crossings = 0;  // of boundaries, here
};

/// The line that a viewer walks.
class Leg {
 public:
  Leg(const ViewCells& cells, std::uint32_t start) : cells_(cells), cell_(start) {
    bends_.push_back({middle_of_cell(cells, start)});
  }
  std::uint32_t cell() const { return cell_; }
  double length() const { return length_; }
  std::uint32_t crossed() const { return crossed_; }
  const std::vector<Bend>& bends() const { return bends_; }

  void cross_to(std::uint32_t next) {
    const Passage passage = passage_between(cells_, cell_, next).value();
    walk_to(passage.leaves);
    if (passage.leaves != passage.enters) bends_.push_back({passage.enters, true});
    ++bends_.back().crossings;
    cell_ = next;
    ++crossed_;
  }
  void walk_to_middle() { walk_to(middle_of_cell(cells_, cell_)); }
  /// Shortens it to this length.
  void cut(double length) {
    while (length_ > length) {
      const Bend last = bends_.back();
      bends_.pop_back();
      crossed_ -= last.crossings;
      if (last.jump) continue;
      const glm::dvec3& before = bends_.back().at;
      const double part = glm::distance(before, last.at);
      length_ -= part;
      if (length_ < length) {
        bends_.push_back({before + (last.at - before) * ((length - length_) / part)});
        length_ = length;
      }
    }
  }

 private:
  void walk_to(const glm::dvec3& to) {
    const double part = glm::distance(bends_.back().at, to);
    if (part < shortest) return;
    if (bends_.size() >= most_poses) refuse("it would have more than a million poses");
    bends_.push_back({to});
    length_ += part;
  }

  const ViewCells& cells_;
  std::uint32_t cell_, crossed_ = 0;
  double length_ = 0;
  std::vector<Bend> bends_;
};

glm::dquat level_camera(double yaw, double pitch) {
  const glm::dvec3 right(std::sin(yaw), -std::cos(yaw), 0);
  const glm::dvec3 ahead(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
  return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(right, ahead), -ahead)));
}

/// Turns legs into poses, one leg after another.
class PoseMaker {
 public:
  explicit PoseMaker(const PathOptions& options) : options_(options) {}

  void add(const Leg& leg) {
    const std::vector<Bend>& bends = leg.bends();
    std::vector<double> length = {0};  // of the leg up to each bend
    for (std::size_t i = 1; i < bends.size(); ++i)
      length.push_back(length.back() + (bends[i].jump ? 0 : glm::distance(bends[i - 1].at, bends[i].at)));
    looks_.reset();  // a new leg begins with a look ahead
    const double begin = time_;
    std::size_t ahead = 1;  // the bend behind the point in a second
    const auto point_ahead = [&](double at) {
      const double wanted = at + options_.speed * looks_ahead;
      while (ahead < bends.size() && length[ahead] < wanted) ++ahead;
      if (ahead >= bends.size()) return bends.back().at;
      const glm::dvec3 &a = bends[ahead - 1].at, &b = bends[ahead].at;
      return a + (b - a) * ((wanted - length[ahead - 1]) / (length[ahead] - length[ahead - 1]));
    };
    add_pose(begin, bends[0].at, point_ahead(0));
    for (std::size_t i = 1; i < bends.size(); ++i) {
      const double part = length[i] - length[i - 1];
      const double steps = bends[i].jump ? 1 : std::ceil(part / options_.speed / between_poses);
      for (double step = 1; step <= steps; ++step) {
        const bool last = step == steps;
        const double at = last ? length[i] : length[i - 1] + part * (step / steps);
        add_pose(begin + at / options_.speed,
                 last ? bends[i].at : bends[i - 1].at + (bends[i].at - bends[i - 1].at) * (step / steps),
                 point_ahead(at));
      }
    }
  }

  void spin(const glm::dvec3& at, double yaw) {
    const double steps = std::ceil(options_.seconds * std::max(1 / between_poses, options_.turn / 45));
    if (steps >= most_poses) refuse("it would have more than a million poses");
    for (double step = 0; step <= steps; ++step) {
      const double time = options_.seconds * (step / steps);
      push({time, at, level_camera(yaw + time * options_.turn * degree, 0)});
    }
  }

  std::vector<Pose> take() { return std::move(poses_); }

 private:
  struct Look {
    double yaw = 0, pitch = 0;
  };

  void add_pose(double time, const glm::dvec3& at, const glm::dvec3& ahead) {
    const glm::dvec3 way = ahead - at;
    const double along = std::hypot(way.x, way.y);
    const double most = options_.turn * degree * (time - time_);
    time_ = time;
    if (const bool first = !looks_; first || glm::length(way) > 1e-3) {
      if (first) looks_ = Look{};
      const double limit = first ? 4 : most;
      const double yaw = along > 1e-3 ? std::atan2(way.y, way.x) : looks_->yaw;
      const double pitch = std::clamp(std::atan2(way.z, along), -steepest, steepest);
      const double turn = std::remainder(yaw - looks_->yaw, 2 * std::numbers::pi);
      looks_->yaw += std::clamp(turn, -limit, limit);
      looks_->pitch += std::clamp(pitch - looks_->pitch, -limit, limit);
    }
    Look look = *looks_;
    if (options_.kind == PathKind::turning)
      look.yaw += glance * std::sin(2 * std::numbers::pi * time / glance_seconds);
    if (options_.kind == PathKind::roofs) look.pitch -= roof_pitch;
    push({time, at, level_camera(look.yaw, look.pitch)});
  }
  void push(const Pose& pose) {
    if (poses_.size() >= most_poses) refuse("it would have more than a million poses");
    poses_.push_back(pose);
  }

  const PathOptions& options_;
  std::vector<Pose> poses_;
  double time_ = 0;
  std::optional<Look> looks_;
};

/// How high the scene's triangles reach, by squares of the plan; each counts in all squares that its box meets.
class Heights {
 public:
  Heights(const Scene& scene, std::size_t cells) {
    for (const glm::vec3& vertex : scene.vertices) grow(around_, vertex);
    side_ = static_cast<std::size_t>(std::clamp(2 * std::sqrt(static_cast<double>(cells)), 64., 1024.));
    highest_.assign(side_ * side_, -INFINITY);
    for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
      Box box = empty_box;
      for (const glm::vec3& corner : corners_of(scene, t)) grow(box, corner);
      for_squares(box, [&](float& height) { height = std::max(height, box.high[2]); });
    }
  }
  float lowest_of_all() const { return around_.low[2]; }
  float highest_of_all() const { return around_.high[2]; }
  /// Of the triangles above and below the box; -infinity if there are none.
  float highest_at(const Box& box) {
    float highest = -INFINITY;
    for_squares(box, [&](float height) { highest = std::max(highest, height); });
    return highest;
  }

 private:
  std::size_t square(float x, unsigned axis) const {
    const double extent = double{around_.high[axis]} - around_.low[axis];
    const double part = extent > 0 ? (double{x} - around_.low[axis]) / extent : 0;
    return static_cast<std::size_t>(std::clamp(part, 0., 1.) * static_cast<double>(side_ - 1));
  }
  template <typename Work>
  void for_squares(const Box& box, const Work& work) {
    for (std::size_t y = square(box.low[1], 1); y <= square(box.high[1], 1); ++y) {
      for (std::size_t x = square(box.low[0], 0); x <= square(box.high[0], 0); ++x)
        work(highest_[y * side_ + x]);
    }
  }

  Box around_ = empty_box;
  std::size_t side_ = 0;
  std::vector<float> highest_;
};

/// Cells among which a viewer walks, and those to which they go.
struct Ground {
  VisibilityMatrix passages;
  std::vector<Box> boxes;
  std::vector<std::uint32_t> goals;
};

Ground ground_of(const ViewCells& cells) {
  Ground ground = {passages_of(cells), cell_bounds(cells), {}};
  ground.goals = largest_part(ground.passages);
  if (ground.goals.size() < 2) refuse("no passage leads from any view cell to another");
  return ground;
}

Ground roofs_of(const Scene& scene, const ViewCells& cells) {
  Ground ground = {{}, cell_bounds(cells), {}};
  Heights heights(scene, cells.count());
  const double least =
      heights.lowest_of_all() + (double{heights.highest_of_all()} - heights.lowest_of_all()) / 4;
  std::vector<bool> open(cells.count()), roof(cells.count());
  for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
    const Box& box = ground.boxes[cell];
    const double below = heights.highest_at(box), height = double{box.high[2]} - box.low[2];
    open[cell] = below <= box.low[2] + height / 2;
    roof[cell] = open[cell] && below > least && below > box.low[2] - height;
  }
  const VisibilityMatrix all = passages_of(cells);
  std::vector<std::vector<std::uint32_t>> passages(cells.count());
  for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
    if (!open[cell]) continue;
    std::ranges::copy_if(all.row(cell), std::back_inserter(passages[cell]),
                         [&](std::uint32_t other) { return open[other]; });
  }
  ground.passages = VisibilityMatrix::from_rows(passages, cells.count());
  ground.goals = largest_part(ground.passages);
  std::erase_if(ground.goals, [&](std::uint32_t cell) { return !roof[cell]; });
  if (ground.goals.size() < 2) {
    refuse(
        "no two connected view cells lie over roofs; 'vismat cells' makes cells in the air, such as --cells "
        "grid:4 or octree, with a "
        "--region that reaches above the roofs");
  }
  return ground;
}

class PathMaker {
 public:
  PathMaker(const ViewCells& cells, const PathOptions& options)
      : cells_(cells), options_(options), random_(options.seed), poses_(options) {}

  std::vector<Pose> spin() {
    const std::uint32_t cell = random_.below(cells_.count());
    poses_.spin(middle_of_cell(cells_, cell), random_.fraction() * 2 * std::numbers::pi);
    return poses_.take();
  }

  std::vector<Pose> to_and_fro(const Ground& ground) {
    const auto way = walk_cells(ground.passages, ground.boxes, options_.way, options_.seed);
    Leg leg(cells_, way[0]);
    while (!enough(leg)) {
      const double before = leg.length();
      for (std::size_t i = 1; i < way.size() && !enough(leg); ++i) leg.cross_to(way[i]);
      leg.walk_to_middle();
      for (std::size_t i = way.size() - 1; i-- > 0 && !enough(leg);) leg.cross_to(way[i]);
      leg.walk_to_middle();
      if (leg.length() == before) refuse_points();
    }
    add(leg);
    return poses_.take();
  }

  std::vector<Pose> to_goals(const Ground& ground, bool jumping) {
    std::uint32_t at = any(ground.goals);
    for (;;) {
      Leg leg(cells_, at);
      const double end_of_leg = jumping ? between_jumps * options_.speed : INFINITY;
      for (std::uint32_t goals = 0; !enough(leg) && leg.length() < end_of_leg; ++goals) {
        if (goals == 1000 && leg.length() == 0) refuse_points();
        const auto way = shortest_way(ground.passages, ground.boxes, leg.cell(), any(ground.goals));
        for (const std::uint32_t next : way) {
          if (enough(leg) || leg.length() >= end_of_leg) break;
          leg.cross_to(next);
        }
        leg.walk_to_middle();
      }
      const bool done = enough(leg);
      if (!done) leg.cut(end_of_leg);
      add(leg);
      if (done) return poses_.take();
      at = far_from(leg.bends().back().at, ground);
    }
  }

 private:
  [[noreturn]] static void refuse_points() { refuse("its view cells are points, all at one place"); }
  std::uint32_t any(const std::vector<std::uint32_t>& of) {
    return of[random_.below(static_cast<std::uint32_t>(of.size()))];
  }
  std::uint32_t far_from(const glm::dvec3& point, const Ground& ground) {
    std::uint32_t farthest = any(ground.goals);
    double most = -1;
    for (int draw = 0; draw < 8; ++draw) {
      const std::uint32_t cell = any(ground.goals);
      const double distance = glm::distance(point, middle_of_cell(cells_, cell));
      if (distance > most) most = distance, farthest = cell;
    }
    return farthest;
  }
  /// Whether the path is as long as it should be, with this leg.
  bool enough(const Leg& leg) const {
    return options_.boundaries ? crossed_ + leg.crossed() >= *options_.boundaries
                               : length_ + leg.length() >= options_.seconds * options_.speed;
  }
  void add(Leg& leg) {
    if (!options_.boundaries) leg.cut(options_.seconds * options_.speed - length_);
    length_ += leg.length();
    crossed_ += leg.crossed();
    poses_.add(leg);
  }

  const ViewCells& cells_;
  const PathOptions& options_;
  Random random_;
  PoseMaker poses_;
  double length_ = 0;  // of the legs that were added
  std::uint32_t crossed_ = 0;
};

void check_options(const ViewCells& cells, const PathOptions& o) {
  if (cells.count() == 0) refuse("the scene has no view cells; 'vismat cells' makes them");
  if (!(o.seconds > 0 && o.seconds <= 1e5)) refuse("it takes more than 0 and at most 1e5 seconds");
  if (!(o.speed > 0 && o.speed <= 1000)) refuse("the speed is above 0 and at most 1000 m/s");
  if (!(o.turn > 0 && o.turn <= 3600))
    refuse("a viewer turns by more than 0 and at most 3600 degrees a second");
  if (o.boundaries && *o.boundaries == 0) refuse("it crosses one boundary at least");
  if (o.boundaries && (o.kind == PathKind::spin || o.kind == PathKind::teleport)) {
    refuse("a spin crosses no boundary, and jumps cross some unseen; give the seconds");
  }
  if (o.way == 0) refuse("a way to and fro crosses one boundary at least");
}

}  // namespace

std::span<const PathKindName> path_kinds() {
  static constexpr std::array<PathKindName, 6> kinds = {{{PathKind::walk, "walk"},
                                                         {PathKind::turning, "turning"},
                                                         {PathKind::to_and_fro, "to-and-fro"},
                                                         {PathKind::spin, "spin"},
                                                         {PathKind::roofs, "roofs"},
                                                         {PathKind::teleport, "teleport"}}};
  return kinds;
}

CameraPath make_camera_path(const Scene& scene, const ViewCells& cells, const PathOptions& options) {
  check_options(cells, options);
  PathMaker maker(cells, options);
  const auto poses = [&] {
    switch (options.kind) {
      case PathKind::spin:
        return maker.spin();
      case PathKind::to_and_fro:
        return maker.to_and_fro(ground_of(cells));
      case PathKind::roofs:
        return maker.to_goals(roofs_of(scene, cells), false);
      default:
        return maker.to_goals(ground_of(cells), options.kind == PathKind::teleport);
    }
  };
  return CameraPath(poses());
}

}  // namespace vismat
