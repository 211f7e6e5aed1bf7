// Tests the names of matrices and scenes in tables.
#include "programs/names.h"

#include <gtest/gtest.h>

namespace vismat {
namespace {

TEST(Names, OfMatrices) {
  EXPECT_EQ(matrix_name("out/data/artificial-1.bsp.h5"), "artificial-1");
  EXPECT_EQ(matrix_name("tiny.cells.bsp.h5"), "tiny.cells");
  EXPECT_EQ(matrix_name("a/small.mtx"), "small");
}

TEST(Names, OfScenes) {
  EXPECT_EQ(scene_name("a/pak1-maps.pk3:maps/oa_koth1.bsp"), "oa_koth1");
  EXPECT_EQ(scene_name("doom.wad:E1M1"), "E1M1");
  EXPECT_EQ(scene_name("plant"), "plant");
}

}  // namespace
}  // namespace vismat
