// The verbs that make scenes and view cells, and those that count and check against a scene.
#include <array>
#include <cstdio>
#include <sstream>

#include "tests/cli/program_fixture.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

TEST_F(Program, MakesScenesOfMeshes) {
  write("two.obj",
        "v 0 0 0\nv 100 0 0\nv 100 200 0\nv 0 200 0\nf 1 2 3 4\nv 500 0 0\nv 600 0 0\nv 500 9 9\n"
        "f 5 6 7\nf 7 6 5\nf 1 1 2\n");
  write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n");
  write("flat.OBJ", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(
      vismat_succeeds("scene two.obj --scale 0.01 --up y -o two.scene.h5").out,
      "two.scene.h5: 2 objects, 3 triangles, 7 vertices; 1 triangles without area left out; 1 duplicate "
      "triangles left out\nbounds           (0, -0.08999999613, 0) to (6, 0, 2)\n"
      "size             6 x 0.09 x 2 m (x, y, z)\n"
      "level faces      most look along y; the scene should have z up: vismat scene --up y turns a mesh that "
      "has y up\n"
      "note             the file does not say what is see-through: every surface counts as opaque\n");
  write("odd.obj", "v 0 nan 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\nl 2 3\np 2\ncall x\n");
  EXPECT_EQ(
      first_line(vismat_succeeds("scene odd.obj -o odd.scene.h5").out),
      "odd.scene.h5: 1 objects, 1 triangles, 3 vertices; 1 unused points that are not numbers within "
      "1e9 left out; 2 lines and single points left out; 1 lines of other kinds ('call' first) left out");
  const std::string info = vismat("info two.scene.h5").out;
  EXPECT_TRUE(
      contains(info, "two.obj, 0.01 m a unit, y up, taken as opaque, objects are connected components"))
      << info;
  EXPECT_EQ(first_line(vismat("scene two.scene.h5 --objects one-a-triangle -o three.scene.h5").out),
            "three.scene.h5: 3 objects, 3 triangles, 7 vertices");
  const auto refuses = [&](const std::string& words, const std::string& why) {
    expect_refusal("scene " + words + " -o none.scene.h5", why);
  };
  refuses("bad.obj",
          "bad.obj: line 4: uses the point of line 3, where 'nan' is not a number within 1e9 of the origin");
  write("two.glb", "glTF");
  refuses("two.glb", "two.glb: its ending names no kind of file that is read: .obj, .ply");
  refuses("flat.OBJ", "flat.OBJ: none of its 1 triangles has an area");
  refuses("two.obj --scale 1e30", "two.obj: a coordinate is farther than 1e9 m");
  refuses("two.obj --scale 0", "a scene's scale is a number above 0");
  refuses("two.obj --weld 1e-9", "the tolerance is 0 or between 1e-6 and 1e9");
  refuses("two.scene.h5 --scale 2", "two.scene.h5: its lengths, its up and its origin are known");
  refuses("two.obj --objects groups", "two.obj: names no groups");
  refuses("two.obj --objects piles", "--objects 'piles': need components, groups, materials, tiles:METRES");
  refuses("two.obj --objects tiles:0", "--objects 'tiles:0': need tiles:METRES");
  refuses("two.obj --origin 1,2", "--origin '1,2': need auto, or three numbers");
  refuses("two.obj --see-through (", "--see-through");
  write("named.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\ng floor\nf 1 2 3\ng wall\nusemtl glass\nf 1 2 5\n");
  vismat_succeeds("scene named.obj --objects groups --see-through glass -o named.scene.h5");
  EXPECT_TRUE(contains(vismat("info named.scene.h5").out, "1 wall")) << "names are shown";
  vismat_succeeds(
      "see named.scene.h5 --cells grid:1 --region 0,0,3,1,1,4 --producer sampled --rays 500 -o named.bsp.h5");
  vismat_succeeds("encode named.bsp.h5 -o named.vmat");
  EXPECT_TRUE(contains(vismat("info named.bsp.h5").out, "source column 1: wall"));
  EXPECT_EQ(vismat("row named.vmat 0 --names").out, "0 floor\n1 wall\n");
  refuses("no.pk3:maps/a.bsp", "no.pk3");
}

TEST_F(Program, MakesViewCells) {
  vismat_succeeds("city --size 2 -o city.scene.h5");
  for (const std::string how : {"file", "grid:5", "ground:0", "octree:24:3"}) {
    const Finished run = vismat_succeeds("cells city.scene.h5 -o cells.scene.h5 --cells " + how);
    EXPECT_TRUE(contains(run.out, " view cells over ")) << how << run.out;
    EXPECT_EQ(contains(run.out, "evaluated"), how.starts_with("octree")) << run.out;
    vismat_succeeds("info cells.scene.h5");
  }
}

TEST_F(Program, CountsTheTrianglesThatAreDrawn) {
  vismat_succeeds("city --size 2 -o city.scene.h5");
  vismat_succeeds("see city.scene.h5 --effort 0 --objects -o city.bsp.h5");
  const Finished run = vismat_succeeds("triangles city.scene.h5 city.bsp.h5 -o table.csv");
  EXPECT_TRUE(contains(run.out, "without back faces"));
  std::istringstream lines(contents("table.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "cell,objects,triangles,at_level_of_detail,facing");
  unsigned cells = 0;
  while (std::getline(lines, line)) {
    std::array<std::uint64_t, 5> n{};
    ASSERT_EQ(std::sscanf(line.c_str(), "%lu,%lu,%lu,%lu,%lu", &n[0], &n[1], &n[2], &n[3], &n[4]), 5) << line;
    EXPECT_EQ(n[0], cells++);
    EXPECT_GE(n[2], n[3]);
    EXPECT_GE(n[3], n[4]);
    EXPECT_GT(n[4], 0u);
  }
  EXPECT_EQ(cells, dataset("city.bsp.h5").matrix.shape().rows);
  expect_refusal("triangles city.scene.h5 city.bsp.h5 --field-of-view 180", "field of view");
}

TEST_F(Program, VerifyChecksAMatrixAgainstItsScene) {
  vismat_succeeds("city --size 4 -o city.scene.h5");
  vismat_succeeds("see city.scene.h5 --effort 0 --objects -o in.bsp.h5 --seen seen.bsp.h5");
  const auto check = [&](const std::string& matrix, const std::string& claim) {
    const std::string samples = test::sanitized ? "5" : "30";
    const Finished run =
        vismat_succeeds("verify --witness city.scene.h5 --samples " + samples + " " + matrix);
    EXPECT_TRUE(contains(run.out, "\n" + claim + " ")) << run.out;
    EXPECT_TRUE(contains(run.out, " " + samples + (samples.size() == 1 ? "          " : "         ") +
                                      samples + "              0\n"))
        << run.out;
  };
  check("in.bsp.h5", "hidden");
  check("seen.bsp.h5", "seen");

  vismat_succeeds("city --size 2 -o small.scene.h5");
  vismat_succeeds("see small.scene.h5 --effort 0 --objects -o small.bsp.h5");
  Dataset blind = dataset("small.bsp.h5");  // now it claims that nothing is seen from anywhere
  const Shape shape = blind.matrix.shape();
  blind.matrix =
      VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(shape.rows), shape.columns);
  blind.guarantee = Guarantee::conservative;
  blind.sight_lines.clear();
  blind.degree_of_visibility.clear();
  write("blind.bsp.h5", blind);
  const Finished refuted = vismat("verify blind.bsp.h5 --witness small.scene.h5 --samples 1 --seed 2");
  EXPECT_EQ(refuted.code, 1);
  EXPECT_TRUE(contains(refuted.error, "entries are not confirmed to be hidden, the first in row "))
      << refuted.error;
  expect_refusal("verify in.bsp.h5", "name the ORIGINAL matrix, or a scene with --witness");
  blind.guarantee = Guarantee::unknown;
  write("blind.bsp.h5", blind);
  expect_refusal("verify blind.bsp.h5 --witness small.scene.h5", "blind.bsp.h5: claims neither");
}

}  // namespace
}  // namespace vismat
