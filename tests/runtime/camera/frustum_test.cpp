// The frustum against the picture: points are shot through pixels, and looked up in it by projecting them.
#include "runtime/camera/frustum.h"

#include <gtest/gtest.h>

#include <numbers>

#include "matrix/base/random.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

struct Camera {
  Pose pose;
  Screen screen;
  double near;
};

std::vector<Camera> cameras() {
  Random random(11);
  std::vector<Camera> all = {{{}, {640, 360, 90}, 0.1}};
  for (int i = 0; i < 40; ++i) {
    Camera c;
    const double size = i % 4 == 0 ? 1e6 : 30;
    for (int axis = 0; axis < 3; ++axis) c.pose.position[axis] = size * (random.fraction() - .5);
    c.pose.rotation = glm::normalize(glm::dquat(random.fraction() - .5, random.fraction() - .5,
                                                random.fraction() - .5, random.fraction() - .5));
    if (i % 5 == 0) c.pose.rotation = glm::angleAxis(std::numbers::pi / 2 * (i % 3), glm::dvec3(1, 0, 0));
    c.screen = {1 + random.below(900), 1 + random.below(900), random.between(2, 170)};
    c.near = i % 3 == 0 ? 0 : random.fraction();
    all.push_back(c);
  }
  return all;
}

TEST(PixelRays, GoThroughTheMiddlesOfPixels) {
  const PixelRays rays({}, {640, 360, 90});  // looks along -z, x right, y up
  const auto expect_ray = [](const glm::dvec3& ray, const glm::dvec3& along) {
    EXPECT_LT(glm::distance(ray, glm::normalize(along)), 1e-15);
  };
  expect_ray(rays(319.5, 179.5), {0, 0, -1});
  expect_ray(rays(-.5, 179.5), {-1, 0, -1});          // the left border
  expect_ray(rays(639.5, 179.5), {1, 0, -1});         // the right border
  expect_ray(rays(319.5, -.5), {0, 360. / 640, -1});  // the top: pixels are square
  expect_ray(rays(0, 0), {-639. / 640, 359. / 640, -1});
  Pose turned;
  turned.rotation = glm::angleAxis(-std::numbers::pi / 2, glm::dvec3(0, 1, 0));
  expect_ray(PixelRays(turned, {640, 360, 90})(319.5, 179.5), {1, 0, 0});
}

TEST(Frustum, HoldsWhatPixelsShow) {
  Random random(2);
  for (const Camera& c : cameras()) {
    const Frustum frustum(c.pose, c.screen, c.near);
    const PixelRays rays(c.pose, c.screen);
    const glm::dvec3 ahead = c.pose.rotation * glm::dvec3(0, 0, -1);
    for (int i = 0; i < 500; ++i) {
      // Corners and borders of the picture, too.
      const auto pick = [&](std::uint32_t size) {
        return i % 3 == 0 ? (random.below(2) == 0 ? -.5 : size - .5) : random.fraction() * size - .5;
      };
      const glm::dvec3 ray = rays(pick(c.screen.width), pick(c.screen.height));
      EXPECT_NEAR(glm::length(ray), 1, 1e-15);
      const double distance = c.near / glm::dot(ray, ahead) + (i % 7 == 0 ? 0 : 1000 * random.fraction());
      const glm::dvec3 point = c.pose.position + ray * distance;
      EXPECT_TRUE(frustum.contains(point));
      // A box with the point in it: from floats below to floats above, and larger ones.
      Box box = empty_box;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<float>(point[static_cast<int>(axis)]);
        const float more = i % 2 == 0 ? 0 : 20 * random.unit();
        box.low[axis] = std::nextafter(at, -INFINITY) - more;
        box.high[axis] = std::nextafter(at, INFINITY) + more * random.unit();
      }
      EXPECT_TRUE(frustum.meets(box));
    }
  }
}

TEST(Frustum, LeavesOutWhatPixelsDoNotShow) {
  Random random(3);
  for (const Camera& c : cameras()) {
    const Frustum frustum(c.pose, c.screen, c.near);
    const double w = std::tan(double{c.screen.field_of_view} * std::numbers::pi / 360);
    const double h = w * c.screen.height / c.screen.width;
    const double size = std::max(1., glm::length(c.pose.position));
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
      glm::dvec3 point = c.pose.position;
      for (int axis = 0; axis < 3; ++axis) point[axis] += 10 * (random.fraction() - .5);
      const glm::dvec3 p =
          glm::conjugate(c.pose.rotation) * (point - c.pose.position);  // in the camera's axes
      const double out = std::max({std::abs(p.x) + w * p.z, std::abs(p.y) + h * p.z, c.near + p.z});
      if (std::abs(out) < 1e-9 * size * (1 + w + h)) continue;
      EXPECT_EQ(frustum.contains(point), out < 0);
      inside += out < 0;
    }
    EXPECT_LT(inside, 2000);
  }
}

TEST(Frustum, IsConservativeForBoxesAndLeavesOutMostOthers) {
  Random random(4);
  std::size_t shown = 0, met = 0, missed = 0;
  for (const Camera& c : cameras()) {
    if (glm::length(c.pose.position) > 100) continue;
    const Frustum frustum(c.pose, c.screen, c.near);
    for (int i = 0; i < 200; ++i) {
      Box box;
      for (unsigned axis = 0; axis < 3; ++axis) {
        box.low[axis] = static_cast<float>(c.pose.position[static_cast<int>(axis)]) + random.between(-40, 40);
        box.high[axis] = box.low[axis] + random.between(0, i % 4 == 0 ? 60 : 6);
      }
      bool seen = false;
      for (int sample = 0; sample < 300 && !seen; ++sample) {
        glm::dvec3 point;
        for (unsigned axis = 0; axis < 3; ++axis)
          point[static_cast<int>(axis)] =
              box.low[axis] + (double{box.high[axis]} - box.low[axis]) * random.fraction();
        seen = frustum.contains(point);
      }
      const bool meets = frustum.meets(box);
      EXPECT_LE(seen, meets);
      shown += seen;
      met += meets && !seen;
      missed += !meets;
    }
  }
  EXPECT_GT(shown, 1000u);
  EXPECT_GT(missed, 1000u);
  EXPECT_LT(met, (shown + missed) / 20);  // with those of which samples missed the part inside
}

TEST(Frustum, LeavesOutABoxBehindItThatReachesAcrossItsPlanes) {
  // It is on the inner side of each of the five planes with one corner, but behind the camera's corner rays.
  const Pose pose = {
      0, {0, 0, 0}, glm::angleAxis(std::numbers::pi / 4, glm::dvec3(0, 1, 0))};  // along (-1, 0, -1)
  const Frustum frustum(pose, {100, 100, 60}, 0);
  EXPECT_TRUE(frustum.meets({{-2, -1, -2}, {-1, 1, -1}}));
  EXPECT_FALSE(frustum.meets({{0.1f, -50, -50}, {50, 50, 50}}));
  EXPECT_FALSE(frustum.meets({{-50, -50, 0.1f}, {50, 50, 50}}));
  EXPECT_TRUE(frustum.meets({{-50, -50, -50}, {50, 50, 50}}));
  EXPECT_TRUE(frustum.meets({{0, 0, 0}, {0, 0, 0}})) << "the camera's own place, without a near plane";
}

TEST(Frustum, RefusesWhatIsNoPicture) {
  EXPECT_THROW(Frustum({}, {0, 100, 90}, 0), std::invalid_argument);
  EXPECT_THROW(PixelRays({}, {100, 100, 180}), std::invalid_argument);
  EXPECT_EQ(test::refusal<std::invalid_argument>([] { Frustum({}, {}, -1); }),
            "a near plane is 0 to 1e9 m from the camera");
  EXPECT_THROW(Frustum({}, {}, NAN), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
