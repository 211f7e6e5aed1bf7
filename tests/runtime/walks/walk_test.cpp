#include "runtime/walks/walk.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "matrix/base/atomic_file.h"
#include "programs/bake.h"
#include "runtime/camera/cell_finder.h"
#include "runtime/camera/path_makers.h"
#include "runtime/walks/level_geometry.h"
#include "tests/sanitized.h"
#include "visibility/generators/dense_city.h"

namespace vismat {
namespace {

namespace fs = std::filesystem;

/// A small city, baked once for all tests of this program.
class Walks : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new fs::path(fs::temp_directory_path() / ("vismat_walks." + std::to_string(getpid())));
    fs::remove_all(*folder_);
    city_ = new SceneFile(
        make_dense_city({.size = test::sanitized ? 2u : 3u, .car_parks = .4f, .car_sides = 12}));
    baked("city");
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder_);
    delete folder_;
    delete city_;
  }

  static BakeOptions bake_options(const std::string& name) {
    BakeOptions options;
    options.folder = *folder_ / name;
    options.visibility.effort = 0;
    options.visibility.threads = 2;
    options.screen = {160, 90, 90};
    return options;
  }
  static fs::path baked(const std::string& name) {
    ThreadJobRunner runner(2);
    bake(*city_, bake_options(name), runner);
    return *folder_ / name;
  }
  /// A copy of the folder, whose files may be damaged.
  static fs::path copy(const std::string& name) {
    fs::remove_all(*folder_ / name);
    fs::copy(*folder_ / "city", *folder_ / name);
    return *folder_ / name;
  }
  static CameraPath path(PathKind kind, double seconds = 40, double speed = 4) {
    PathOptions options;
    options.kind = kind;
    options.seconds = seconds;
    options.speed = speed;
    return make_camera_path(city_->scene, city_->cells, options);
  }
  static WalkOptions options(const std::string& system = "vlod") {
    WalkOptions walk;
    walk.system = system;
    walk.frames = 200;
    walk.screen = {160, 90, 90};
    walk.cache_bytes = 16 << 20;
    walk.threads = 1;
    return walk;
  }
  static WalkSummary walked(const WalkOptions& walk_options, const CameraPath& path,
                            const fs::path& folder = *folder_ / "city") {
    const BakedScene scene(folder);
    return summary_of(walk(scene, path, walk_options).frames, walk_options.screen);
  }

  static inline fs::path* folder_ = nullptr;
  static inline SceneFile* city_ = nullptr;
};

TEST_F(Walks, NoSystemShowsAWrongPixelIfFramesWait) {
  for (const PathKind kind : {PathKind::walk, PathKind::turning, PathKind::teleport}) {
    const CameraPath way = path(kind);
    for (const WalkSystemInfo& system : walk_systems()) {
      WalkOptions walk = options(std::string(system.name));
      walk.frames = test::trials(100u);
      walk.image_every = kind == PathKind::walk ? 1 : 4;
      const WalkSummary sum = walked(walk, way);
      EXPECT_EQ(sum.errors, ImageErrors{}) << system.name;
      EXPECT_EQ(sum.images, walk.frames / walk.image_every);
      EXPECT_EQ(sum.late + sum.failed + sum.frames_without_cell, 0u) << system.name;
      EXPECT_GT(sum.mean_triangles, 0);
    }
  }
}

TEST_F(Walks, NoWrongPixelIfTheCacheIsTooSmallForACell) {
  const CameraPath way = path(PathKind::walk);
  WalkOptions walk = options();
  walk.image_every = 8;
  // The smallest budget that holds the largest chunk besides what the cache itself takes.
  for (walk.cache_bytes = 8192;; walk.cache_bytes += 1024) {
    try {
      walked(walk, CameraPath({way.at(0)}));
      break;
    } catch (const std::invalid_argument&) {
      ASSERT_LT(walk.cache_bytes, 1u << 20);
    }
  }
  const WalkSummary sum = walked(walk, way);
  EXPECT_GT(sum.overflow, 0u);
  EXPECT_EQ(sum.errors, ImageErrors{});
  EXPECT_LE(sum.most_cached_bytes, walk.cache_bytes);
  walk.cache_bytes = 1000;
  EXPECT_THROW(walked(walk, way), std::invalid_argument);
}

TEST_F(Walks, VisibilityAndLevelsDrawLess) {
  const CameraPath way = path(PathKind::walk);
  const WalkSummary everything = walked(options("everything"), way),
                    frustum = walked(options("frustum"), way),
                    levels = walked(options("frustum-levels"), way),
                    lists = walked(options("cell-lists"), way), vlod = walked(options(), way);
  EXPECT_GT(everything.mean_triangles, frustum.mean_triangles);
  EXPECT_GT(frustum.mean_triangles, levels.mean_triangles);
  EXPECT_GT(levels.mean_triangles, 1.2 * vlod.mean_triangles);
  EXPECT_EQ(lists.mean_triangles, vlod.mean_triangles) << "the same sets, by rows and by differences";
  EXPECT_GT(vlod.crossings, 10u);
  EXPECT_EQ(vlod.jumps, 1u) << "the first cell";
}

TEST_F(Walks, PrefetchesStallFewerFrames) {
  const CameraPath way = path(PathKind::walk, 60, 4);
  WalkOptions walk = options();
  walk.frames = 1000;
  const WalkSummary with = walked(walk, way);
  walk.prefetch_depth = 0;
  const WalkSummary without = walked(walk, way);
  EXPECT_GT(without.stalled_frames_after_the_first_cell, 5u);
  EXPECT_LT(with.stalled_frames_after_the_first_cell * 2, without.stalled_frames_after_the_first_cell);
  EXPECT_EQ(without.prefetched, 0u);
}

TEST_F(Walks, TheLogIsTheSameForAnyNumberOfThreads) {
  const BakedScene scene(*folder_ / "city");
  for (const WalkMode mode : {WalkMode::wait, WalkMode::deadline}) {
    const CameraPath way = path(PathKind::teleport);
    WalkOptions walk_options = options();
    walk_options.mode = mode;
    walk_options.image_every = 20;
    walk_options.disk = disk_model("network");
    const std::string one = to_csv(walk(scene, way, walk_options).frames);
    for (const unsigned threads : {2u, 8u}) {
      walk_options.threads = threads;
      EXPECT_EQ(to_csv(walk(scene, way, walk_options).frames), one);
    }
    walk_options.seed = 2;
    if (mode == WalkMode::wait) {
      EXPECT_NE(to_csv(walk(scene, way, walk_options).frames), one) << "the jitter";
    }
  }
}

TEST_F(Walks, CountsWhatIsLateIfFramesDoNotWait) {
  WalkOptions walk = options();
  walk.mode = WalkMode::deadline;
  walk.frames = test::trials(200u);
  walk.image_every = 1;
  walk.disk = parse_disk_model("400,1,1");
  walk.prefetch_depth = 0;
  const WalkSummary sum = walked(walk, path(PathKind::walk));
  EXPECT_EQ(sum.stall_ms, 0);
  EXPECT_GT(sum.errors.missing, 1000u);
  walk.disk = disk_model("nvme");
  walk.prefetch_depth = 1;
  walk.frames = 2000;
  walk.image_every = 20;
  const BakedScene scene(*folder_ / "city");
  const CameraPath way = path(PathKind::walk);
  std::uint64_t wrong = 0;
  for (const FrameRecord& frame : vismat::walk(scene, way, walk).frames)
    wrong += frame.frame > 0 ? frame.errors.all() : 0;
  EXPECT_LT(wrong, 1000u) << "what the first frame lacks apart";
}

TEST_F(Walks, APoseInNoCellDrawsTheFrustumAndIsCountedApart) {
  const CameraPath above(
      {Pose{0, {30, 30, 60}, glm::dquat(1, 0, 0, 0)}, Pose{1, {31, 30, 60}, glm::dquat(1, 0, 0, 0)}});
  WalkOptions walk_options = options();
  walk_options.frames = 3;
  walk_options.image_every = 1;
  const BakedScene scene(*folder_ / "city");
  const Walk done = walk(scene, above, walk_options);
  EXPECT_EQ(summary_of(done.frames, walk_options.screen).frames_without_cell, 3u);
  for (const FrameRecord& frame : done.frames) {
    EXPECT_EQ(frame.cell, FrameRecord::no_cell);
    EXPECT_GT(frame.drawn_objects, 10u);
    EXPECT_EQ(frame.errors, ImageErrors{});
  }
  EXPECT_NE(to_csv(done.frames).find(",no cell,"), std::string::npos);
}

void flip(const fs::path& file, std::uint64_t at) {
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekg(static_cast<std::streamoff>(at));
  const int old = bytes.get();
  bytes.seekp(static_cast<std::streamoff>(at));
  bytes.put(static_cast<char>(old ^ 16));
}

TEST_F(Walks, GoesOnWithoutADamagedChunk) {
  const fs::path damaged = copy("damaged");
  const CameraPath way = path(PathKind::walk);
  const BakedScene whole(*folder_ / "city");
  const std::uint32_t cell = CellFinder(city_->cells).find(way.at(0).position);
  const std::uint32_t ground = whole.versions_from(cell)[0];
  flip(damaged / baked::geometry, whole.geometry().offset(ground) + 20);
  const BakedScene scene(damaged);
  WalkOptions walk_options = options();
  const Walk done = walk(scene, way, walk_options);
  ASSERT_EQ(done.faults.size(), 1u);
  EXPECT_NE(done.faults[0].find("frame 0: object 0 at level "), std::string::npos) << done.faults[0];
  const WalkSummary sum = summary_of(done.frames, walk_options.screen);
  EXPECT_GT(sum.failed, 100u) << "the frames that show less are marked";
  EXPECT_EQ(sum.frames, 200u);
}

TEST_F(Walks, RefusesAFolderOfAnotherSceneOrWithoutAFile) {
  ThreadJobRunner runner(2);
  const SceneFile other = make_dense_city({.size = 2, .car_sides = 8});
  EXPECT_THROW(bake(other, bake_options("city"), runner), std::invalid_argument);
  const auto refused = [&](const std::string& name, const std::string& why) {
    try {
      BakedScene scene(*folder_ / name);
      ADD_FAILURE() << "opens " << name;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  bake(other, bake_options("other"), runner);
  for (const char* file : {baked::geometry, baked::facing, baked::summary}) {
    copy("mixed");
    fs::copy_file(*folder_ / "other" / file, *folder_ / "mixed" / file, fs::copy_options::overwrite_existing);
    refused("mixed", "another scene");
  }
  for (const char* file :
       {baked::scene, baked::geometry, baked::facing, baked::summary, baked::rows, baked::lists}) {
    fs::remove(copy("less") / file);
    refused("less", file);
  }
  EXPECT_THROW(walked(options("teleporter"), path(PathKind::walk)), std::invalid_argument);
}

TEST_F(Walks, ABakeGivesTheSameBytesForAnyThreadsAndAfterAStop) {
  BakeOptions one = bake_options("one");
  one.visibility.threads = 1;
  ThreadJobRunner runner(1);
  bake(*city_, one, runner);
  fs::remove(one.folder / baked::summary);  // as if it had been stopped after the matrix
  fs::remove(one.folder / baked::geometry);
  one.visibility.threads = 8;
  bake(*city_, one, runner);
  for (const char* file :
       {baked::matrix, baked::geometry, baked::facing, baked::summary, baked::rows, baked::lists}) {
    EXPECT_EQ(read_file(one.folder / file), read_file(*folder_ / "city" / file)) << file;
  }
}

TEST(LevelGeometry, IsReadBackAndRefusedWhereDamaged) {
  LevelGeometry geometry{{{0, 0, 0}, {1, 0, 0}, {0, 1, .5f}}, {{0, 1, 2}, {2, 1, 0}}};
  const std::vector<std::byte> chunk = to_chunk(geometry);
  EXPECT_EQ(chunk.size(), 8u + 36 + 12);
  EXPECT_EQ(geometry_from_chunk(chunk), geometry);
  for (std::size_t length = 0; length < chunk.size(); ++length) {
    EXPECT_THROW(geometry_from_chunk(std::span(chunk).first(length)), FormatError);
  }
  std::vector<std::byte> bad = chunk;
  bad[44] = std::byte{3};  // a corner beyond the vertices
  EXPECT_THROW(geometry_from_chunk(bad), FormatError);
  geometry.vertices.resize(70000);
  EXPECT_EQ(geometry_from_chunk(to_chunk(geometry)), geometry);
}

}  // namespace
}  // namespace vismat
