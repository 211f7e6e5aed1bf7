// vismat path: makes, checks, resamples and converts camera paths.
#include "tests/cli/program_fixture.h"

namespace vismat {
namespace {

TEST_F(Program, MakesPathsThroughViewCells) {
  vismat_succeeds("city --size 4 -o city.scene.h5");
  for (const std::string kind : {"walk", "turning", "to-and-fro", "spin", "teleport"}) {
    const Finished run =
        vismat_succeeds("path city.scene.h5 --kind " + kind + " --seconds 12 --speed 2 -o a.path");
    EXPECT_TRUE(contains(run.out, ", from 0 to 12 s\n")) << run.out;
    EXPECT_TRUE(contains(run.out, kind == "spin" ? "way              0 m" : "way              24 m"))
        << run.out;
    EXPECT_EQ(contains(run.out, "jumps            none"), kind != "teleport") << run.out;
    EXPECT_TRUE(contains(run.out, "in no cell       0 %")) << run.out;
    // What is written says the same when it is read.
    EXPECT_EQ(vismat_succeeds("path a.path --scene city.scene.h5").out, run.out);
    vismat_succeeds("path city.scene.h5 --kind " + kind + " --seconds 12 --speed 2 -o again.path");
    EXPECT_EQ(contents("again.path"), contents("a.path"));
    vismat_succeeds("path city.scene.h5 --kind " + kind + " --seconds 12 --speed 2 --seed 2 -o other.path");
    EXPECT_NE(contents("other.path"), contents("a.path"));
  }
  vismat_succeeds("path city.scene.h5 --seconds 60 -o default.path");
  vismat_succeeds("path city.scene.h5 --kind walk --speed 1.5 --turn 120 --seed 1 -o a.path");
  EXPECT_EQ(contents("default.path"), contents("a.path"));
  const Finished crossed = vismat_succeeds("path city.scene.h5 --boundaries 9 -o a.path");
  EXPECT_TRUE(contains(crossed.out, ", 9 changes, of which 0 to a cell that is no neighbour")) << crossed.out;

  vismat_succeeds("cells city.scene.h5 --cells grid:5 --region 0,0,0,80,80,40 -o grid.scene.h5");
  vismat_succeeds("path grid.scene.h5 --kind roofs --seconds 5 -o roofs.path");
}

TEST_F(Program, ChecksResamplesAndConvertsPaths) {
  write("a.path", "# a jump\n0 0 0 0 0 0 0 1\n1 2 0 0 0 0 1 0\n1 9 0 0 0 0 0 1\n3 9 0 0 0 0 0 1\n");
  EXPECT_EQ(vismat_succeeds("path a.path").out,
            "poses            4, from 0 to 3 s\n"
            "way              2 m in 3 s\n"
            "jumps            1, the longest 7 m\n"
            "speed            mean 0.667 m/s, at most 2 m/s\n"
            "turning          mean 60 degrees/s, at most 180 degrees/s\n");
  vismat_succeeds("path a.path --frames 7 -o frames.path");
  EXPECT_EQ(count_lines(contents("frames.path")), 7u);
  EXPECT_TRUE(contains(contents("frames.path"), "1 9 0 0 0 0 0 1\n1.5 9 0 0 0 0 0 1\n"));
  vismat_succeeds("path a.path --frames 1 -o frames.path");
  EXPECT_EQ(contents("frames.path"), "0 0 0 0 0 0 0 1\n");

  // A camera of TUM that is not turned has the axes of the scene: it looks along their z, and its y points down theirs.
  write("tum.txt", "0 1 2 3 0 0 0 1\n");
  vismat_succeeds("path tum.txt --from tum --to opengl -o gl.path");
  EXPECT_EQ(contents("gl.path"), "0 1 2 3 1 0 -0 -0\n");
  vismat_succeeds("path gl.path --to tum -o back.txt");
  EXPECT_EQ(contents("back.txt"), contents("tum.txt"));
}

TEST_F(Program, RefusesWhatIsNoPath) {
  vismat_succeeds("city --size 2 -o city.scene.h5");
  write("good.path", "0 0 0 0 0 0 0 1\n");
  write("falls.path", "1 0 0 0 0 0 0 1\n# time\n0 0 0 0 0 0 0 1\n");
  write("empty.path", "# nothing\n");
  write("nan.path", "0 0 nan 0 0 0 0 1\n");
  write("zero.path", "0 0 0 0 0 0 0 0\n");
  write("short.path", "0 0 0 0\n");
  expect_refusal("path falls.path", "falls.path: line 3: time falls from 1 to 0");
  expect_refusal("path empty.path", "empty.path: holds no pose");
  expect_refusal("path nan.path", "nan.path: line 1: y nan is not within 1e9 m");
  expect_refusal("path zero.path", "zero.path: line 1: the quaternion's length is 0, not 1");
  expect_refusal("path short.path", "short.path: line 1: 4 words; a pose is eight numbers");
  expect_refusal("path good.path --frames 0 -o a.path", "--frames");
  expect_refusal("path good.path --frames 5", "--frames");
  expect_refusal("path good.path --from quake -o a.path", "--from");
  expect_refusal("path good.path --kind walk -o a.path",
                 "good.path: no scene file (.scene.h5), which --kind is for");
  expect_refusal("path good.path --seed 3 -o a.path", "which --seed is for");
  expect_refusal("path good.path -o ./good.path", "is the input");
  expect_refusal("path good.path --scene good.path", "good.path");
  expect_refusal("path city.scene.h5", "city.scene.h5: a scene; name the path to make, -o");
  expect_refusal("path city.scene.h5 --from tum -o a.path", "--from tells the axes of a path that is read");
  expect_refusal("path city.scene.h5 --kind streets -o a.path", "--kind");
  expect_refusal("path city.scene.h5 --kind spin --boundaries 2 -o a.path",
                 "camera path: a spin crosses no boundary");
  expect_refusal("path city.scene.h5 --seconds 2 --boundaries 2 -o a.path", "excludes");
  expect_refusal("path city.scene.h5 --kind roofs -o a.path",
                 "city.scene.h5: camera path: no two connected view cells lie over roofs");
  expect_refusal("path city.scene.h5 -o a.bsp.h5", "is the name of a matrix or scene");
  write("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  vismat_succeeds("scene two.obj -o two.scene.h5");
  expect_refusal("path two.scene.h5 -o a.path",
                 "two.scene.h5: camera path: the scene has no view cells; 'vismat cells' makes them");
}

}  // namespace
}  // namespace vismat
