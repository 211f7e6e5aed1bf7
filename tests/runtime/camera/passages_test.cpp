#include "runtime/camera/passages.h"

#include <gtest/gtest.h>

#include "runtime/camera/cell_finder.h"
#include "tests/runtime/camera/some_cells.h"

namespace vismat {
namespace {

void expect_at(const std::optional<Passage>& passage, const glm::dvec3& leaves, const glm::dvec3& enters) {
  ASSERT_TRUE(passage);
  EXPECT_LT(glm::distance(passage->leaves, leaves), 1e-6);
  EXPECT_LT(glm::distance(passage->enters, enters), 1e-6);
}

TEST(Passages, LeadThroughTheMiddleOfWhatCellsShare) {
  ViewCells cells;
  cells.corners = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, 2}, {0, 4, 0}, {4, 0, 0}};  // the second slopes
  cells.eye_low = 1;
  cells.eye_high = 2;
  cells.boxes = {{{-3, 1, 0}, {0, 2, 5}}, {{-9, -9, 4}, {-2, 9, 6}}, {{-1, 1, 0}, {0, 5, 1}}};
  expect_at(passage_between(cells, 0, 1), {2, 2, 1.5}, {2, 2, 1.5});
  expect_at(passage_between(cells, 0, 2), {0, 1.5, 1.5}, {0, 1.5, 1.5});
  expect_at(passage_between(cells, 2, 3), {-2.5, 1.5, 4.5}, {-2.5, 1.5, 4.5});
  EXPECT_FALSE(passage_between(cells, 0, 3));
  EXPECT_FALSE(passage_between(cells, 1, 2));
  EXPECT_EQ(passages_of(cells).row(0).size(), 2u);
}

TEST(Passages, LeadFromStepToStep) {
  ViewCells cells;
  cells.corners = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 3, .25f}, {0, 1, .25f}, {-4, 1, .25f}};
  expect_at(passage_between(cells, 0, 1), {0, 2, 1.6}, {0, 2, 1.85});
  expect_at(passage_between(cells, 1, 0), {0, 2, 1.85}, {0, 2, 1.6});
  EXPECT_EQ(passages_of(cells).ones(), 0u) << "no neighbours, as far as is known";
  cells.neighbours = VisibilityMatrix::from_rows({{1}, {0}}, 2);
  EXPECT_EQ(passages_of(cells), *cells.neighbours);
  cells.eye_high = 2;  // eyes at 1.85 to 2 have room in both
  expect_at(passage_between(cells, 0, 1), {0, 2, 1.925}, {0, 2, 1.925});
}

TEST(Passages, JoinAllNeighboursOfAnyCells) {
  for (const test::SomeCells& some : test::some_cells()) {
    SCOPED_TRACE(some.name);
    const ViewCells& cells = some.file.cells;
    const VisibilityMatrix passages = passages_of(cells);
    if (cells.neighbours) {
      EXPECT_EQ(passages, *cells.neighbours);
    }
    EXPECT_EQ(passages, transpose(passages));
    EXPECT_GT(passages.ones(), 0u);
    const CellFinder finder(cells);
    for (std::uint32_t a = 0; a < cells.count(); ++a) {
      for (const std::uint32_t b : passages.row(a)) {
        const Passage passage = passage_between(cells, a, b).value(),
                      back = passage_between(cells, b, a).value();
        EXPECT_TRUE(finder.holds(a, passage.leaves, CellFinder::rounding));
        EXPECT_TRUE(finder.holds(b, passage.enters, CellFinder::rounding));
        EXPECT_EQ(passage.leaves, back.enters);
        EXPECT_EQ(passage.enters, back.leaves);
        EXPECT_TRUE(passage.leaves == passage.enters || some.name == "hillside");
      }
    }
  }
}

}  // namespace
}  // namespace vismat
