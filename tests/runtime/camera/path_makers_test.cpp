#include "runtime/camera/path_makers.h"

#include <gtest/gtest.h>

#include <set>

#include "matrix/base/random.h"
#include "runtime/camera/cell_finder.h"
#include "runtime/camera/passages.h"
#include "tests/refusal.h"
#include "tests/runtime/camera/some_cells.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

bool has_roofs(const std::string& name) {
  return name == "grid" || name == "octree";
}

std::string refusal_of(const SceneFile& file, const PathOptions& options) {
  return test::refusal<std::invalid_argument>([&] { make_camera_path(file.scene, file.cells, options); });
}

/// The poses, and the middles between those of different times.
std::vector<Pose> with_middles(const CameraPath& path) {
  std::vector<Pose> all;
  for (const Pose& pose : path.poses()) {
    if (!all.empty() && pose.time > all.back().time)
      all.push_back(path.at((all.back().time + pose.time) / 2));
    all.push_back(pose);
  }
  return all;
}

double longest_step(const SceneFile& file, const VisibilityMatrix& passages) {
  double longest = 0;
  for (std::uint32_t a = 0; a < file.cells.count(); ++a) {
    for (const std::uint32_t b : passages.row(a)) {
      const Passage passage = passage_between(file.cells, a, b).value();
      longest = std::max(longest, glm::distance(passage.leaves, passage.enters));
    }
  }
  return longest;
}

TEST(PathMakers, EveryPositionIsInACellAndTheNextInTheSameOrANeighbour) {
  for (const test::SomeCells& some : test::some_cells()) {
    const ViewCells& cells = some.file.cells;
    const CellFinder finder(cells);
    const VisibilityMatrix passages = passages_of(cells);
    const double step = longest_step(some.file, passages);
    for (const PathKindName& kind : path_kinds()) {
      if (kind.kind == PathKind::roofs && !has_roofs(some.name)) continue;
      for (std::uint64_t seed = 1; seed <= test::trials(5u); ++seed) {
        SCOPED_TRACE(some.name + ", " + std::string(kind.name) + ", seed " + std::to_string(seed));
        const PathOptions options = {.kind = kind.kind, .seconds = 40, .speed = 3, .way = 3, .seed = seed};
        const CameraPath path = make_camera_path(some.file.scene, cells, options);
        EXPECT_EQ(path.begin(), 0);
        EXPECT_NEAR(path.end(), 40, 1e-9);
        for (const std::uint32_t cell : cells_along(finder, path.frames(1000)))
          EXPECT_NE(cell, CellFinder::none);

        const std::vector<Pose> poses = with_middles(path);
        const std::vector<std::uint32_t> along = cells_along(finder, poses);
        double metres = 0;
        for (std::size_t i = 0; i < poses.size(); ++i) {
          ASSERT_NE(along[i], CellFinder::none);
          EXPECT_NEAR(glm::length(poses[i].rotation), 1, 1e-12);
          const glm::dvec3 right = poses[i].rotation * glm::dvec3(1, 0, 0);
          EXPECT_NEAR(right.z, 0, .02) << "level; between two poses, as far as an even turn can be";
          EXPECT_GT((poses[i].rotation * glm::dvec3(0, 1, 0)).z, 0) << "not upside down";
          if (i == 0) continue;
          const double way = glm::distance(poses[i - 1].position, poses[i].position);
          const double time = poses[i].time - poses[i - 1].time;
          if (time == 0) {
            EXPECT_TRUE(kind.kind == PathKind::teleport || way <= step + 1e-9) << way;
            continue;
          }
          EXPECT_TRUE(along[i] == along[i - 1] || passages.contains(along[i - 1], along[i])) << i;
          EXPECT_NEAR(way, kind.kind == PathKind::spin ? 0 : 3 * time, 1e-9);
          metres += way;
        }
        EXPECT_NEAR(metres, kind.kind == PathKind::spin ? 0 : 120, 1e-6);
      }
    }
  }
}

TEST(PathMakers, GoAsFarAsIsAskedFor) {
  for (const test::SomeCells& some : test::some_cells()) {
    const CellFinder finder(some.file.cells);
    for (const PathKindName& kind : path_kinds()) {
      if (kind.kind == PathKind::spin || kind.kind == PathKind::teleport ||
          (kind.kind == PathKind::roofs && !has_roofs(some.name)))
        continue;
      for (const std::uint32_t boundaries : {1u, 7u, 50u}) {
        SCOPED_TRACE(some.name + ", " + std::string(kind.name));
        const CameraPath path =
            make_camera_path(some.file.scene, some.file.cells, {.kind = kind.kind, .boundaries = boundaries});
        const std::vector<Pose> poses = with_middles(path);
        const std::vector<std::uint32_t> along = cells_along(finder, poses);
        std::uint32_t crossed = 0;
        for (std::size_t i = 1; i < along.size(); ++i) {
          crossed += along[i] != along[i - 1];
        }
        EXPECT_EQ(crossed, boundaries);
      }
    }
  }
}

TEST(PathMakers, LookWhereTheyGo) {
  const SceneFile file = make_dense_city({.size = 4, .step = 8, .interiors = 0, .car_sides = 8});
  const CameraPath walk = make_camera_path(file.scene, file.cells, {.seconds = 300});
  const CameraPath turning =
      make_camera_path(file.scene, file.cells, {.kind = PathKind::turning, .seconds = 300});
  ASSERT_EQ(walk.poses().size(), turning.poses().size());
  double most_glance = 0, most_turn = 0;
  std::size_t astray = 0;
  for (std::size_t i = 1; i < walk.poses().size(); ++i) {
    const Pose &a = walk.poses()[i - 1], &b = walk.poses()[i], &c = turning.poses()[i];
    const glm::dvec3 looks = a.rotation * glm::dvec3(0, 0, -1), next = b.rotation * glm::dvec3(0, 0, -1);
    astray += glm::dot(looks, glm::normalize(b.position - a.position)) < 0.5;
    most_turn = std::max(most_turn, std::acos(std::min(1., glm::dot(looks, next))) / (b.time - a.time));
    EXPECT_EQ(b.position, c.position);
    const double glance = std::acos(std::min(1., glm::dot(next, c.rotation * glm::dvec3(0, 0, -1))));
    most_glance = std::max(most_glance, glance);
  }
  EXPECT_LT(astray, walk.poses().size() / 20);
  EXPECT_LT(most_turn, glm::radians(121.));
  EXPECT_NEAR(most_glance, glm::radians(60.), glm::radians(1.));
}

TEST(PathMakers, DoWhatTheirKindSays) {
  const std::vector<test::SomeCells> all = test::some_cells();
  for (const test::SomeCells& some : all) {
    SCOPED_TRACE(some.name);
    const ViewCells& cells = some.file.cells;
    const CellFinder finder(cells);
    const auto cells_of = [&](const PathOptions& options) {
      const CameraPath path = make_camera_path(some.file.scene, cells, options);
      const auto along = cells_along(finder, with_middles(path));
      return std::set<std::uint32_t>(along.begin(), along.end());
    };
    EXPECT_EQ(cells_of({.kind = PathKind::to_and_fro}).size(), 2u);
    EXPECT_LE(cells_of({.kind = PathKind::to_and_fro, .seconds = 1000, .way = 4}).size(), 5u);
    EXPECT_EQ(cells_of({.kind = PathKind::spin}).size(), 1u);
    EXPECT_NE(cells_of({.seed = 1}), cells_of({.seed = 2}));
    const CameraPath teleport = make_camera_path(some.file.scene, cells, {.kind = PathKind::teleport});
    double farthest = 0;
    for (std::size_t i = 1; i < teleport.poses().size(); ++i) {
      if (teleport.poses()[i].time == teleport.poses()[i - 1].time)
        farthest =
            std::max(farthest, glm::distance(teleport.poses()[i].position, teleport.poses()[i - 1].position));
    }
    EXPECT_GT(farthest, 10);
    const PathOptions roofs = {.kind = PathKind::roofs, .seconds = 200, .speed = 5};
    if (some.name == "hillside") continue;  // its upper steps are as good as roofs
    if (!has_roofs(some.name)) {
      EXPECT_TRUE(refusal_of(some.file, roofs)
                      .starts_with("camera path: no two connected view cells lie over roofs"));
      continue;
    }
    double lowest = INFINITY, highest = 0;
    const CameraPath over = make_camera_path(some.file.scene, cells, roofs);
    for (const Pose& pose : over.poses()) {
      lowest = std::min(lowest, pose.position.z);
      highest = std::max(highest, pose.position.z);
      EXPECT_LT((pose.rotation * glm::dvec3(0, 0, -1)).z, .5);
    }
    EXPECT_GT(lowest, 6) << "the lowest box";
    EXPECT_LT(highest, 40);
  }
}

TEST(PathMakers, SpinTurnsEvenly) {
  const SceneFile file = make_city({.size = 2});
  const CameraPath path =
      make_camera_path(file.scene, file.cells, {.kind = PathKind::spin, .seconds = 3, .turn = 90});
  const auto yaw = [](const Pose& pose) {
    const glm::dvec3 looks = pose.rotation * glm::dvec3(0, 0, -1);
    return std::atan2(looks.y, looks.x);
  };
  const double first = yaw(path.at(0));
  for (double time = 0; time <= 3; time += .173) {
    const double turned = std::remainder(yaw(path.at(time)) - first - glm::radians(90. * time), 2 * M_PI);
    EXPECT_NEAR(turned, 0, 1e-12) << time;
  }
}

TEST(PathMakers, AreTheSameForTheSameSeed) {
  const SceneFile file = make_city({.size = 4});
  for (const PathKindName& kind : path_kinds()) {
    if (kind.kind == PathKind::roofs) continue;
    const auto text = [&](std::uint64_t seed) {
      return to_text(make_camera_path(file.scene, file.cells, {.kind = kind.kind, .seed = seed}));
    };
    EXPECT_EQ(text(3), text(3));
    EXPECT_NE(text(3), text(4));
  }
}

TEST(PathMakers, RefuseWhatCannotBe) {
  SceneFile file = make_city({.size = 2});
  const auto expect_refusal = [&](const PathOptions& options, const std::string& why) {
    EXPECT_EQ(refusal_of(file, options), "camera path: " + why);
  };
  expect_refusal({.seconds = 0}, "it takes more than 0 and at most 1e5 seconds");
  expect_refusal({.speed = NAN}, "the speed is above 0 and at most 1000 m/s");
  expect_refusal({.turn = 0}, "a viewer turns by more than 0 and at most 3600 degrees a second");
  expect_refusal({.kind = PathKind::teleport, .boundaries = 1},
                 "a spin crosses no boundary, and jumps cross some unseen; give the seconds");
  expect_refusal({.boundaries = 0}, "it crosses one boundary at least");
  expect_refusal({.kind = PathKind::spin, .boundaries = 1},
                 "a spin crosses no boundary, and jumps cross some unseen; give the seconds");
  expect_refusal({.way = 0}, "a way to and fro crosses one boundary at least");
  expect_refusal({.kind = PathKind::spin, .seconds = 1e5, .turn = 3600},
                 "it would have more than a million poses");
  file.cells.neighbours = VisibilityMatrix({file.cells.count(), file.cells.count()});
  expect_refusal({}, "no passage leads from any view cell to another");
  EXPECT_EQ(refusal_of(file, {.kind = PathKind::spin}), "");
  file.cells = {};
  file.cells.boxes.resize(2);
  file.cells.neighbours = VisibilityMatrix::from_rows({{1}, {0}}, 2);
  for (const PathKind kind : {PathKind::walk, PathKind::teleport, PathKind::to_and_fro})
    expect_refusal({.kind = kind}, "its view cells are points, all at one place");
  file.cells = {};
  expect_refusal({}, "the scene has no view cells; 'vismat cells' makes them");
}

}  // namespace
}  // namespace vismat
