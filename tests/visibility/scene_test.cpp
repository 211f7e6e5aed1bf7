#include "visibility/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/hdf5_file.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

/// Two triangles, each an object of its own; two cells that touch; a root with two leaves.
SceneFile small_scene() {
  SceneFile file;
  file.scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, 3}, {5, 1, 0}, {6, 1, 0}, {5, 2, 4}};
  file.scene.indices = {0, 1, 2, 3, 4, 5};
  file.scene.object_of_triangle = {0, 1};
  file.scene.object_count = 2;
  file.cells.corners = {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 0, 0}, {9, 9, 0}, {0, 9, 1}};
  file.cells.eye_low = 1;
  file.cells.eye_high = 2;
  file.cells.neighbours = VisibilityMatrix::from_rows({{1}, {0}}, 2);
  file.tree = ObjectTree::from_parents({ObjectTree::none, 0, 0}, {ObjectTree::none, 0, 1}, 2);
  file.provenance = "by hand";
  file.seed = 7;
  return file;
}

TEST(Scene, BoundsOfObjects) {
  Scene scene = small_scene().scene;
  scene.object_count = 3;
  const std::vector<Box> bounds = object_bounds(scene);
  ASSERT_EQ(bounds.size(), 3u);
  EXPECT_EQ(bounds[0], (Box{{0, 0, 0}, {1, 0, 3}}));
  EXPECT_EQ(bounds[1], (Box{{5, 1, 0}, {6, 2, 4}}));
  EXPECT_EQ(bounds[2], Box{}) << "no triangles: the empty box";
}

TEST(Scene, BoundsOfCellsReachFromTheLowestEyeToTheHighest) {
  const std::vector<Box> bounds = cell_bounds(small_scene().cells);
  ASSERT_EQ(bounds.size(), 2u);
  EXPECT_EQ(bounds[0], (Box{{0, 0, 1}, {9, 9, 2}}));
  EXPECT_EQ(bounds[1], (Box{{0, 0, 1}, {9, 9, 3}}));
}

TEST(Scene, RoundTrip) {
  const TemporaryFolder folder;
  const SceneFile before = small_scene();
  write_scene(folder / "a.scene.h5", before);
  const SceneFile after = read_scene(folder / "a.scene.h5");
  EXPECT_EQ(after.scene.vertices, before.scene.vertices);
  EXPECT_EQ(after.scene.indices, before.scene.indices);
  EXPECT_EQ(after.scene.object_of_triangle, before.scene.object_of_triangle);
  EXPECT_EQ(after.scene.object_count, before.scene.object_count);
  EXPECT_EQ(after.cells.corners, before.cells.corners);
  EXPECT_EQ(after.cells.eye_low, before.cells.eye_low);
  EXPECT_EQ(after.cells.eye_high, before.cells.eye_high);
  EXPECT_EQ(after.cells.neighbours, before.cells.neighbours);
  EXPECT_EQ(after.tree, before.tree);
  EXPECT_EQ(after.provenance, before.provenance);
  EXPECT_EQ(after.seed, before.seed);
}

TEST(Scene, RoundTripOfBoxesAndOfWhatIsSeenThrough) {
  const TemporaryFolder folder;
  SceneFile before = small_scene();
  before.cells.boxes = {{{0, 0, 0}, {1, 2, 3}}, {{-4, 5, 6}, {-4, 5, 7}}};
  before.cells.neighbours = VisibilityMatrix::from_rows({{1}, {0, 2}, {1}, {}}, 4);
  before.scene.see_through = {0, 1};
  write_scene(folder / "a.scene.h5", before);
  const SceneFile after = read_scene(folder / "a.scene.h5");
  EXPECT_EQ(after.cells.corners, before.cells.corners);
  EXPECT_EQ(after.cells.boxes, before.cells.boxes);
  EXPECT_EQ(after.cells.neighbours, before.cells.neighbours);
  EXPECT_EQ(after.cells.count(), 4u);
  EXPECT_EQ(after.scene.see_through, before.scene.see_through);
}

TEST(Scene, RoundTripOfNamesAndOrigin) {
  const TemporaryFolder folder;
  SceneFile before = small_scene();
  before.scene.object_names = {"house", "garden"};
  before.scene.object_names.resize(before.scene.object_count);
  before.origin = {691000.1, 5300000.25, -1e-3};
  before.opacity_unknown = true;
  write_scene(folder / "a.scene.h5", before);
  const SceneFile after = read_scene(folder / "a.scene.h5");
  EXPECT_EQ(after.scene.object_names, before.scene.object_names);
  EXPECT_EQ(after.origin, before.origin);
  EXPECT_TRUE(after.opacity_unknown);
}

TEST(Scene, NeedsNoViewCells) {
  const TemporaryFolder folder;
  write_scene(folder / "a.scene.h5", small_scene());
  {
    Hdf5File file = Hdf5File::create(folder / "b.scene.h5");
    const Hdf5File full = Hdf5File::open(folder / "a.scene.h5");
    const auto vertices = full.read<float>("/scene/vertices");
    file.write<float>("/scene/vertices", vertices, {vertices.size() / 3, 3});
    for (const std::string name : {"/scene/triangles", "/scene/object_of_triangle"}) {
      const auto ids = full.read<std::uint32_t>(name);
      file.write<std::uint32_t>(name, ids, full.dimensions(name));
    }
    file.write_attribute("/scene", "version", std::uint64_t{2});
    file.write_attribute("/scene", "object_count", std::uint64_t{2});
    file.close();
  }
  const SceneFile read = read_scene(folder / "b.scene.h5");
  EXPECT_EQ(read.cells.count(), 0u);
  EXPECT_EQ(read.scene.indices, small_scene().scene.indices);
}

TEST(Scene, ReadsVersionOne) {
  const TemporaryFolder folder;
  {
    Hdf5File file = Hdf5File::create(folder / "old.scene.h5");
    const std::vector<float> vertices = {0, 0, 0, 1, 0, 0, 0, 0, 3}, corners = {0, 0, 0, 9, 0, 0, 9, 9, 0};
    file.write<float>("/scene/vertices", vertices, {3, 3});
    file.write<std::uint32_t>("/scene/triangles", std::array{0u, 1u, 2u}, {1, 3});
    file.write<std::uint32_t>("/scene/object_of_triangle", std::array{0u}, {1});
    file.write_attribute("/scene", "version", std::uint64_t{1});
    file.write_attribute("/scene", "object_count", std::uint64_t{1});
    file.write<float>("/cells/corners", corners, {3, 3});
    file.write<float>("/cells/eye_heights", std::array{1.6f, 1.8f}, {2});
    file.close();
  }
  const SceneFile old = read_scene(folder / "old.scene.h5");
  EXPECT_EQ(old.scene.indices, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(old.scene.see_through.empty());
  EXPECT_EQ(old.cells.count(), 1u);
  EXPECT_TRUE(old.cells.boxes.empty());
  EXPECT_EQ(old.cells.eye_high, 1.8f);
}

TEST(Scene, BoundsOfCellsAreThoseOfTheirSolids) {
  ViewCells cells = small_scene().cells;
  cells.boxes = {{{0, 0, 0}, {1, 2, 3}}, {{-4, 5, 6}, {-4, 5, 7}}};
  for (const float factor : {1.0f, 0.5f, 3.0f}) {
    const ViewCells other = factor == 1 ? cells : resized(cells, factor);
    const std::vector<Box> bounds = cell_bounds(other);
    for (std::uint32_t cell = 0; cell < other.count(); ++cell) {
      const Convex solid = convex_of(other, cell);
      for (unsigned axis = 0; axis < 3; ++axis) {
        double low = solid.vertices[0][static_cast<int>(axis)], high = low;
        for (const glm::dvec3& vertex : solid.vertices) {
          low = std::min(low, vertex[static_cast<int>(axis)]);
          high = std::max(high, vertex[static_cast<int>(axis)]);
        }
        EXPECT_FLOAT_EQ(static_cast<float>(low), bounds[cell].low[axis]);
        EXPECT_FLOAT_EQ(static_cast<float>(high), bounds[cell].high[axis]);
        const Box whole = cell_bounds(cells)[cell];
        if (cell >= cells.prisms()) {
          EXPECT_FLOAT_EQ(bounds[cell].high[axis] - bounds[cell].low[axis],
                          factor * (whole.high[axis] - whole.low[axis]));
        }
      }
    }
  }
}

TEST(Scene, WhatIsNotKnownStaysUnknown) {
  const TemporaryFolder folder;
  SceneFile before = small_scene();
  before.cells.neighbours.reset();
  before.tree.reset();
  before.seed.reset();
  write_scene(folder / "a.scene.h5", before);
  const SceneFile after = read_scene(folder / "a.scene.h5");
  EXPECT_FALSE(after.cells.neighbours);
  EXPECT_FALSE(after.tree);
  EXPECT_FALSE(after.seed);
}

struct Hostile {
  const char* name;
  std::function<void(SceneFile&)> spoil;
  const char* message;  // part of what must be said
};

class HostileScene : public testing::TestWithParam<Hostile> {};

TEST_P(HostileScene, IsRefusedInOneLineThatSaysWhere) {
  const TemporaryFolder folder;
  SceneFile file = small_scene();
  GetParam().spoil(file);
  write_scene(folder / "bad.scene.h5", file);
  try {
    read_scene(folder / "bad.scene.h5");
    FAIL() << "was accepted";
  } catch (const FormatError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("bad.scene.h5: "), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Each, HostileScene,
    testing::Values(
        Hostile{"TooFewNames", [](SceneFile& f) { f.scene.object_names = {"one"}; }, "/scene/object_names"},
        Hostile{"NanVertex", [](SceneFile& f) { f.scene.vertices[4].y = nan; }, "/scene/vertices, entry 4"},
        Hostile{"EndlessVertex", [](SceneFile& f) { f.scene.vertices[5].z = -infinity; },
                "/scene/vertices, entry 5"},
        Hostile{"FarVertex", [](SceneFile& f) { f.scene.vertices[0].x = 3e38f; }, "/scene/vertices, entry 0"},
        Hostile{"NoSuchVertex", [](SceneFile& f) { f.scene.indices[3] = 6; },
                "/scene/triangles, entry 3: vertex 6 of only 6"},
        Hostile{"NoSuchObject", [](SceneFile& f) { f.scene.object_of_triangle[1] = 2; },
                "/scene/object_of_triangle, entry 1: object 2 of only 2"},
        Hostile{"TooFewTriangles", [](SceneFile& f) { f.scene.indices.resize(3); },
                "2 entries for 3 corners"},
        Hostile{"ObjectsOutOfThinAir", [](SceneFile& f) { f.scene.object_count = 4000000000u; },
                "object_count 4000000000"},
        Hostile{"TwoCornersOfACell", [](SceneFile& f) { f.cells.corners.resize(5); },
                "/cells/corners: 5 points"},
        Hostile{"NanCorner", [](SceneFile& f) { f.cells.corners[1].z = nan; }, "/cells/corners, entry 1"},
        Hostile{"EyesUpsideDown", [](SceneFile& f) { f.cells.eye_low = 3; }, "/cells/eye_heights"},
        Hostile{"NanEyes", [](SceneFile& f) { f.cells.eye_high = nan; }, "/cells/eye_heights"},
        Hostile{"NeighboursOfOtherCells",
                [](SceneFile& f) {
                  f.cells.neighbours = VisibilityMatrix::from_rows({{1}, {0}, {}}, 3);
                },
                "/cells/neighbours"},
        Hostile{"OneSidedNeighbours",
                [](SceneFile& f) {
                  f.cells.neighbours = VisibilityMatrix::from_rows({{1}, {}}, 2);
                },
                "/cells/neighbours"},
        Hostile{"BoxUpsideDown",
                [](SceneFile& f) {
                  f.cells.boxes = {{{0, 0, 1}, {1, 1, 0}}};
                },
                "/cells/boxes, entry 0"},
        Hostile{"NanBox",
                [](SceneFile& f) {
                  f.cells.boxes = {{}, {{0, 0, nan}, {1, 1, 1}}};
                },
                "/cells/boxes, entry 1"},
        Hostile{"EndlessBox",
                [](SceneFile& f) {
                  f.cells.boxes = {{{0, 0, 0}, {1, infinity, 1}}};
                },
                "/cells/boxes, entry 0"},
        Hostile{"NeighboursOfThePrismsAlone",
                [](SceneFile& f) {
                  f.cells.boxes = {{{0, 0, 0}, {1, 1, 1}}};
                },
                "/cells/neighbours"},
        Hostile{"SeeThroughOfOtherObjects", [](SceneFile& f) { f.scene.see_through = {1}; },
                "/scene/see_through: 1 entries"},
        Hostile{"TreeOfOtherObjects",
                [](SceneFile& f) {
                  f.tree = ObjectTree::from_parents({ObjectTree::none, 0}, {0, 2}, 3);
                },
                "/tree"}),
    [](const testing::TestParamInfo<Hostile>& test) { return test.param.name; });

TEST(Scene, RefusesWhatIsNoSceneFile) {
  const TemporaryFolder folder;
  EXPECT_ANY_THROW(read_scene(folder / "missing.scene.h5"));
  const std::string text = "this is not HDF5";
  write_file(folder / "text.scene.h5", std::as_bytes(std::span(text)));
  EXPECT_THROW(read_scene(folder / "text.scene.h5"), FormatError);
  Hdf5File::create(folder / "empty.h5").close();
  EXPECT_THROW(read_scene(folder / "empty.h5"), FormatError);
}

TEST(Scene, RefusesTruncatedFiles) {
  const TemporaryFolder folder;
  write_scene(folder / "whole.scene.h5", small_scene());
  const std::vector<std::byte> bytes = read_file(folder / "whole.scene.h5");
  for (std::size_t part = 0; part < 8; ++part) {
    write_file(folder / "part.scene.h5", std::span(bytes).first(bytes.size() * part / 8));
    EXPECT_THROW(read_scene(folder / "part.scene.h5"), FormatError) << part << "/8";
  }
}

}  // namespace
}  // namespace vismat
