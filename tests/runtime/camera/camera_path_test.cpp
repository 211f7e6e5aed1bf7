#include "runtime/camera/camera_path.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

std::string refusal_of(const std::string& text) {
  return test::refusal<FormatError>([&] { parse_camera_path(text, "a.path"); });
}

glm::dvec3 looks(const Pose& pose) {
  return pose.rotation * glm::dvec3(0, 0, -1);
}

glm::dquat about(const glm::dvec3& axis, double degrees) {
  return glm::angleAxis(degrees * std::numbers::pi / 180, axis);
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
  EXPECT_LT(glm::distance(a, b), 1e-12) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(CameraPath, ReadsOnePoseALine) {
  const CameraPath path = parse_camera_path(
      "# a comment\n\n  0 1 2 3 0 0 0 1  # another\r\n1.5e0\t-1 .5 +3 0 0 1 0\r2 0 0 0 -0.5 0.5 0.5 0.5",
      "a.path");
  ASSERT_EQ(path.poses().size(), 3u);
  EXPECT_EQ(path.poses()[0], (Pose{0, {1, 2, 3}, {1, 0, 0, 0}}));
  EXPECT_EQ(path.poses()[1], (Pose{1.5, {-1, .5, 3}, {0, 0, 0, 1}}));
  EXPECT_EQ(path.poses()[2], (Pose{2, {0, 0, 0}, {.5, -.5, .5, .5}}));
  EXPECT_EQ(path.begin(), 0);
  EXPECT_EQ(path.end(), 2);
}

TEST(CameraPath, RefusesWithTheLine) {
  EXPECT_EQ(refusal_of(""), "a.path: holds no pose; each is a line: t x y z qx qy qz qw");
  EXPECT_EQ(refusal_of("# nothing\n\n"), "a.path: holds no pose; each is a line: t x y z qx qy qz qw");
  const std::string good = "0 0 0 0 0 0 0 1\n#\n";
  EXPECT_EQ(refusal_of(good + "1 0 0 0 0 0 1"),
            "a.path: line 3: 7 words; a pose is eight numbers: t x y z qx qy qz qw");
  EXPECT_EQ(refusal_of(good + "1 0 0 0 0 0 0 1 9\n"),
            "a.path: line 3: 9 words; a pose is eight numbers: t x y z qx qy qz qw");
  EXPECT_EQ(refusal_of(good + "1 0 0 0 0 0 zero 1"),
            "a.path: line 3: 'zero' stands where one of a pose's eight numbers is due");
  EXPECT_EQ(refusal_of(good + "1 0,5 0 0 0 0 0 1"),
            "a.path: line 3: '0,5' stands where one of a pose's eight numbers is due; write numbers with a "
            "point, not a comma");
  EXPECT_EQ(refusal_of(good + "-1 0 0 0 0 0 0 1"), "a.path: line 3: time falls from 0 to -1");
  EXPECT_EQ(refusal_of("nan 0 0 0 0 0 0 1"),
            "a.path: line 1: time nan is no number of seconds within 9e9 of 0");
  EXPECT_EQ(refusal_of("1403636579763555584 0 0 0 0 0 0 1"),
            "a.path: line 1: time 1403636579763555584 is no number of seconds within 9e9 of 0; are these "
            "nanoseconds?");
  EXPECT_EQ(refusal_of("0 0 nan 0 0 0 0 1"), "a.path: line 1: y nan is not within 1e9 m of the origin");
  EXPECT_EQ(refusal_of("0 0 0 -inf 0 0 0 1"), "a.path: line 1: z -inf is not within 1e9 m of the origin");
  EXPECT_EQ(refusal_of("0 1e999 0 0 0 0 0 1"), "a.path: line 1: x inf is not within 1e9 m of the origin");
  EXPECT_EQ(refusal_of(good + "1 0 0 0 0 0 0 0"),
            "a.path: line 3: the quaternion's length is 0, not 1; no rotation is 0 0 0 1");
  EXPECT_EQ(refusal_of("0 0 0 0 0 0 90 1"),
            "a.path: line 1: the quaternion's length is 90.00555538409837, not 1");
  EXPECT_EQ(refusal_of("0 0 0 0 nan 0 0 1"), "a.path: line 1: the quaternion's length is nan, not 1");
  EXPECT_EQ(refusal_of("0 0 0 0 1e300 0 0 1"), "a.path: line 1: the quaternion's length is inf, not 1");
  EXPECT_EQ(test::refusal<FormatError>([] { parse_camera_path("x", "b.path"); }).substr(0, 7), "b.path:");
  EXPECT_THROW(read_camera_path("no such file"), std::runtime_error);
}

TEST(CameraPath, RoundedQuaternionsGetUnitLength) {
  // The first line of a ground truth of the TUM RGB-D benchmark, and two digits of the same.
  for (const char* text : {"1305031098.6659 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986\n",
                           "1305031098.6659 1.3563 0.6305 1.6380 0.61 0.60 -0.33 -0.40\n"}) {
    const CameraPath path = parse_camera_path(text, "", CameraAxes::tum);
    EXPECT_NEAR(glm::length(path.poses()[0].rotation), 1, 1e-15);
    EXPECT_EQ(path.poses()[0].time, 1305031098.6659);
  }
  EXPECT_NE(refusal_of("0 0 0 0 0 0 0 1.02"), "");
}

TEST(CameraPath, TumCamerasLookAlongZWithYDown) {
  // No rotation: x right, y down, z ahead are the scene's x, y, z.
  const CameraPath path = parse_camera_path("0 0 0 0 0 0 0 1", "", CameraAxes::tum);
  const glm::dquat q = path.poses()[0].rotation;
  expect_near(looks(path.poses()[0]), {0, 0, 1});
  expect_near(q * glm::dvec3(1, 0, 0), {1, 0, 0});
  expect_near(q * glm::dvec3(0, 1, 0), {0, -1, 0});
  // Looking along the scene's y, upright (z up): right is x, down is -z.
  const glm::dquat level = glm::quat_cast(glm::dmat3({1, 0, 0}, {0, 0, -1}, {0, 1, 0}));
  std::string text = "0 0 0 0 " + std::to_string(level.x) + ' ' + std::to_string(level.y) + ' ' +
                     std::to_string(level.z) + ' ' + std::to_string(level.w);
  const CameraPath upright = parse_camera_path(text, "", CameraAxes::tum);
  EXPECT_LT(glm::distance(looks(upright.poses()[0]), {0, 1, 0}), 1e-5);
  EXPECT_LT(glm::distance(upright.poses()[0].rotation * glm::dvec3(0, 1, 0), {0, 0, 1}), 1e-5);
}

TEST(CameraPath, WhatIsWrittenIsReadBitByBit) {
  Random random(5);
  std::vector<Pose> poses;
  for (int i = 0; i < 300; ++i) {
    Pose pose;
    pose.time = (i / 2) * 0.1 + 1305031098.6659;  // pairs of equal times
    for (int axis = 0; axis < 3; ++axis) pose.position[axis] = (random.fraction() - .5) * std::pow(10, i % 9);
    pose.rotation = glm::normalize(glm::dquat(random.fraction() - .5, random.fraction() - .5,
                                              random.fraction() - .5, random.fraction() - .5));
    poses.push_back(pose);
  }
  const CameraPath path(poses);
  for (const CameraAxes axes : {CameraAxes::opengl, CameraAxes::tum}) {
    const std::string text = to_text(path, axes);
    const CameraPath again = parse_camera_path(text, "", axes);
    EXPECT_TRUE(std::ranges::equal(again.poses(), path.poses()));
    EXPECT_EQ(to_text(again, axes), text);
  }
  EXPECT_EQ(to_text(CameraPath({{.5, {1, -2, 1e-20}, {0, 1, 0, 0}}})), "0.5 1 -2 1e-20 1 0 0 0\n");
}

TEST(CameraPath, PosesBetweenAreLinearAndTurnTheShortWay) {
  const glm::dquat quarter = about({0, 0, 1}, 90);
  const CameraPath path({{1, {0, 0, 0}, {1, 0, 0, 0}}, {3, {4, 0, 2}, -quarter}});  // -q turns as q does
  for (const double part : {0., .25, .5, .9, 1.}) {
    const Pose pose = path.at(1 + 2 * part);
    EXPECT_EQ(pose.time, 1 + 2 * part);
    expect_near(pose.position, {4 * part, 0, 2 * part});
    expect_near(pose.rotation * glm::dvec3(1, 0, 0), about({0, 0, 1}, 90 * part) * glm::dvec3(1, 0, 0));
    EXPECT_NEAR(glm::length(pose.rotation), 1, 1e-15);
  }
  EXPECT_EQ(path.at(1), path.poses()[0]);
  EXPECT_EQ(path.at(3), path.poses()[1]);
  EXPECT_EQ(path.at(-7), (Pose{-7, {0, 0, 0}, {1, 0, 0, 0}}));
  EXPECT_EQ(path.at(99), (Pose{99, {4, 0, 2}, -quarter}));
}

TEST(CameraPath, EqualTimesAreAJump) {
  const CameraPath path({{0, {0, 0, 0}}, {1, {1, 0, 0}}, {1, {5, 0, 0}}, {1, {9, 0, 0}}, {2, {10, 0, 0}}});
  EXPECT_EQ(path.at(1).position.x, 9);
  EXPECT_NEAR(path.at(std::nextafter(1., 0.)).position.x, 1, 1e-12);
  EXPECT_EQ(path.at(1.5).position.x, 9.5);
  const CameraPath at_the_ends({{0, {0, 0, 0}}, {0, {1, 0, 0}}, {1, {2, 0, 0}}, {1, {3, 0, 0}}});
  EXPECT_EQ(at_the_ends.frames(1)[0].position.x, 1);
  EXPECT_EQ(at_the_ends.frames(2)[0].position.x, 1);
  EXPECT_EQ(at_the_ends.frames(2)[1].position.x, 3);
}

TEST(CameraPath, FramesAreEvenlySpacedAndExactlySoMany) {
  const CameraPath path({{10, {0, 0, 0}}, {10.3, {1, 0, 0}}, {13, {2, 0, 0}}});
  for (const std::uint32_t count : {1u, 2u, 3u, 7u, 1000u}) {
    const auto frames = path.frames(count);
    ASSERT_EQ(frames.size(), count);
    for (std::uint32_t f = 0; f < count; ++f) {
      EXPECT_NEAR(frames[f].time, 10 + (count == 1 ? 0 : 3. * f / (count - 1)), 1e-14 * 13);
      EXPECT_EQ(frames[f], path.at(frames[f].time));
    }
    EXPECT_EQ(frames[0], path.poses()[0]);
    EXPECT_EQ(frames.back(), path.poses()[count > 1 ? 2 : 0]);
    // A path of the frames gives the same frames again.
    const auto again = CameraPath(frames).frames(count);
    for (std::uint32_t f = 0; f < count; ++f) expect_near(again[f].position, frames[f].position);
  }
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { path.frames(0); }),
            "a camera path is shown in one frame at least");
  EXPECT_EQ(CameraPath({{4, {1, 2, 3}}}).frames(3)[2], (Pose{4, {1, 2, 3}}));
}

TEST(CameraPath, OfWrongPosesIsRefused) {
  const auto refusal = [](std::vector<Pose> poses) {
    return test::refusal<std::invalid_argument>([&] { CameraPath path(poses); });
  };
  EXPECT_EQ(refusal({}), "a camera path without poses");
  EXPECT_EQ(refusal({{1}, {0}}), "pose 1 of a camera path: time falls from 1 to 0");
  EXPECT_EQ(refusal({{0, {}, {1, 0, 0, 1e-2}}}),
            "pose 0 of a camera path: the quaternion's length is 1.0000499987500624, not 1");
  EXPECT_NE(refusal({{std::numeric_limits<double>::quiet_NaN()}}), "");
}

}  // namespace
}  // namespace vismat
