#include "runtime/images/item_buffer.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "visibility/generators/dense_city.h"
#include "visibility/scene.h"

namespace vismat {
namespace {

/// Adds a square of the plane y = `y`, 2 * half wide about (x, z), as an object of its own.
void add_square(Scene& scene, float x, float y, float z, float half) {
  const auto base = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.insert(
      scene.vertices.end(),
      {{x - half, y, z - half}, {x + half, y, z - half}, {x + half, y, z + half}, {x - half, y, z + half}});
  scene.indices.insert(scene.indices.end(), {base, base + 1, base + 2, base, base + 2, base + 3});
  scene.object_of_triangle.insert(scene.object_of_triangle.end(), 2, scene.object_count++);
}

/// A camera at the origin that looks along +y, with z up.
Pose along_y() {
  return {0, {0, 0, 0}, glm::dquat(std::sqrt(.5), std::sqrt(.5), 0, 0)};
}
constexpr Screen square{40, 40, 90};

Scene only(const Scene& scene, std::span<const std::uint8_t> drawn) {
  Scene some = scene;
  some.indices.clear(), some.object_of_triangle.clear();
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    if (drawn[scene.object_of_triangle[t]] == 0) continue;
    some.object_of_triangle.push_back(scene.object_of_triangle[t]);
    for (std::size_t i = 0; i < 3; ++i) some.indices.push_back(scene.indices[3 * t + i]);
  }
  return some;
}

TEST(ItemBuffer, ShowsTheNearestObjectOfEachPixel) {
  Scene scene;
  add_square(scene, 0, 10, 0, 5);       // the middle half of the picture each way
  add_square(scene, 2.5f, 5, 0, 2.5f);  // before its right half, and beyond it to the right
  const ItemImage image = ItemBuffer(scene).draw(along_y(), square, 0);
  const auto at = [&](unsigned x, unsigned y) { return image.object[y * 40 + x]; };
  EXPECT_EQ(at(1, 1), ItemImage::background);
  EXPECT_EQ(at(11, 20), 0u);
  EXPECT_EQ(at(11, 9), ItemImage::background) << "above the square's upper rim";
  EXPECT_EQ(at(11, 10), 0u);
  EXPECT_EQ(at(21, 20), 1u) << "the nearer one";
  EXPECT_EQ(at(39, 20), 1u);
  EXPECT_NEAR(image.depth[20 * 40 + 20], 5, .01);
  EXPECT_EQ(image.depth[0], std::numeric_limits<float>::infinity());
}

TEST(ItemBuffer, LeavesOutWhatIsBeforeTheNearPlaneOrSeeThrough) {
  Scene scene;
  add_square(scene, 0, 10, 0, 5);
  add_square(scene, 0, 2, 0, 1);
  const auto middle = [&](double near) {
    return ItemBuffer(scene).draw(along_y(), square, near).object[20 * 40 + 20];
  };
  EXPECT_EQ(middle(1.99), 1u);
  EXPECT_EQ(middle(2.01), 0u);
  scene.see_through = {0, 1};
  EXPECT_EQ(middle(0), 0u);
}

TEST(ItemBuffer, DrawsSomeObjectsAsASceneOfTheseAlone) {
  const SceneFile city = make_dense_city({.size = 3});
  const ItemBuffer all(city.scene);
  std::mt19937 random(7);
  std::uint64_t wrong = 0;
  for (const Screen screen : {Screen{64, 48, 90}, Screen{33, 21, 60}}) {  // whole packets, and not
    for (unsigned i = 0; i < 8; ++i) {
      const Box& cell = city.cells.boxes[random() % city.cells.boxes.size()];
      const double turn = static_cast<double>(random() % 628) / 200;
      const Pose pose{0, glm::dvec3(cell.low[0] + cell.high[0], cell.low[1] + cell.high[1], 3) * .5,
                      glm::dquat(std::cos(turn), 0, 0, std::sin(turn)) * along_y().rotation};
      const ItemImage reference = all.draw(pose, screen, .1, 2);
      std::vector<std::uint8_t> drawn(city.scene.object_count);
      for (std::uint8_t& d : drawn) d = random() % 3 != 0;
      const ItemImage some = all.draw_only(drawn, reference, pose, screen, .1, 2);
      EXPECT_EQ(some,
                ItemBuffer(only(city.scene, drawn), RayCaster::Preparation::soon).draw(pose, screen, .1, 1));
      wrong += errors_of(some, reference).all();
      const ItemImage same =
          all.draw_only(std::vector<std::uint8_t>(drawn.size(), 1), reference, pose, screen, .1);
      EXPECT_EQ(same, reference);
    }
  }
  EXPECT_GT(wrong, 1000u) << "or nothing was cast again";
}

TEST(ImageErrors, TellsMissingWrongAndExtraApart) {
  constexpr std::uint32_t none = ItemImage::background;
  const float far = std::numeric_limits<float>::infinity();
  const ItemImage reference{6, 1, {1, 1, 1, none, none, 1}, {5, 5, 5, far, far, 5}};
  const ItemImage image{6, 1, {1, 2, 2, 3, none, none}, {5, 9, 5, 7, far, far}};
  EXPECT_EQ(errors_of(image, reference), (ImageErrors{2, 1, 1}));
  EXPECT_EQ(errors_of(reference, reference).all(), 0u);
  EXPECT_THROW(errors_of(image, ItemImage{1, 1, {none}, {far}}), std::invalid_argument);
}

TEST(ImageErrors, FindsObjectsWithinReachAndNoFarther) {
  // A coarse picture of 4 x 1 pixels with 2 x 2 samples each: object 1 left of the middle, 2 right of it.
  const std::vector<float> no_depth(16, 1);
  ItemImage coarse{4, 1, {1, 1, 2, 2}, {1, 1, 1, 1}}, fine{8, 2, {}, no_depth};
  for (unsigned y = 0; y < 2; ++y) fine.object.insert(fine.object.end(), {1, 1, 1, 1, 2, 2, 2, 2});
  EXPECT_EQ(far_from(coarse, fine, 2, .1), 0u);
  EXPECT_EQ(lost_in(coarse, fine, 2, .1), 0u);
  coarse.object = {2, 1, 2,
                   2};  // 2 begins 1.5 pixels and half a sample, 1.75 pixels, right of this pixel's middle
  EXPECT_EQ(far_from(coarse, fine, 2, 1.7), 1u);
  EXPECT_EQ(far_from(coarse, fine, 2, 1.9), 0u);
  coarse.object = {1, 1, 2, 2};
  fine.object[0] = 3;  // an object that no pixel has
  EXPECT_EQ(lost_in(coarse, fine, 2, 100), 1u);
  EXPECT_EQ(far_from(coarse, fine, 2, .6), 0u);
  EXPECT_THROW(far_from(coarse, coarse, 2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
