#include "runtime/camera/cell_finder.h"

#include <gtest/gtest.h>

#include "matrix/base/random.h"
#include "tests/runtime/camera/some_cells.h"
#include "visibility/geometry/point_bounds.h"

namespace vismat {
namespace {

constexpr std::uint32_t none = CellFinder::none;

bool slowly_holds(const Convex& cell, const glm::dvec3& point, double tolerance) {
  bool inside = true;
  for (const Convex::Face& face : cell.faces)
    inside &= glm::dot(face.normal, point) - face.offset <= tolerance;
  return inside;
}

std::uint32_t slowly_found(const std::vector<Convex>& cells, const glm::dvec3& point,
                           std::uint32_t previous) {
  for (const double tolerance : {0., CellFinder::rounding}) {
    if (previous != none && slowly_holds(cells[previous], point, tolerance)) return previous;
    for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
      if (slowly_holds(cells[cell], point, tolerance)) return cell;
    }
  }
  return none;
}

TEST(CellFinder, FindsWhatAllCellsInTurnFind) {
  Random random(8);
  for (const test::SomeCells& some : test::some_cells()) {
    SCOPED_TRACE(some.name);
    const CellFinder finder(some.file.cells);
    std::vector<Convex> cells;
    for (std::uint32_t cell = 0; cell < some.file.cells.count(); ++cell)
      cells.push_back(convex_of(some.file.cells, cell));
    std::size_t found = 0, nowhere = 0, kept = 0;
    for (int i = 0; i < 3000; ++i) {
      const std::uint32_t any = random.below(some.file.cells.count());
      const auto& vertices = cells[any].vertices;
      // Its middle, a vertex, a point between two of them or of all, and one near.
      glm::dvec3 point = vertices[random.below(static_cast<std::uint32_t>(vertices.size()))];
      if (i % 4 == 1) point = middle_of(vertices);
      if (i % 4 == 2) point = (point + vertices[0]) / 2.;
      if (i % 4 == 3) {
        for (int axis = 0; axis < 3; ++axis) point[axis] += random.fraction() - .5;
      }
      const std::uint32_t previous = i % 3 == 0   ? none
                                     : i % 3 == 1 ? any
                                                  : random.below(some.file.cells.count());
      const std::uint32_t cell = finder.find(point, previous);
      ASSERT_EQ(cell, slowly_found(cells, point, previous)) << i;
      found += cell != none;
      nowhere += cell == none;
      kept += cell != none && cell != finder.find(point);
    }
    EXPECT_GT(found, 2000u);
    EXPECT_GT(nowhere, 10u);
    EXPECT_GT(kept, 10u) << "a cell that is not the lowest is kept";
  }
}

TEST(CellFinder, KeepsTheCellWhoseFaceAViewerWalksAlong) {
  ViewCells cells;
  cells.boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{2, 0, 0}, {2, 1, 1}}};
  const CellFinder finder(cells);
  EXPECT_EQ(finder.find({1, .5, .5}), 0u);
  EXPECT_EQ(finder.find({1, .5, .5}, 1), 1u);
  EXPECT_EQ(finder.find({1, .5, .5}, 2), 0u);
  EXPECT_EQ(finder.find({1 + 1e-9, .5, .5}, 0), 1u) << "exactly in a cell before nearly in another";
  EXPECT_EQ(finder.find({2 + 5e-7, .5, .5}), 1u) << "no cell holds it exactly";
  EXPECT_EQ(finder.find({2 + 5e-7, .5, .5}, 2), 2u);
  EXPECT_EQ(finder.find({2 + 2e-6, .5, .5}), none);
  EXPECT_EQ(finder.find({1, .5, .5}, 77), 0u) << "no such cell";
  EXPECT_EQ(finder.find({NAN, .5, .5}), none);
  EXPECT_EQ(CellFinder(ViewCells{}).find({0, 0, 0}), none);
}

}  // namespace
}  // namespace vismat
