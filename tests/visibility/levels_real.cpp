// The levels that fetch-levels unpacked, if it ran: known sizes of oa_koth1, and what holds of all of them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "visibility/levels/level_file.h"

namespace vismat {
namespace {

class RealLevels : public testing::Test {
 protected:
  void SetUp() override {
    const char* cache = std::getenv("VISMAT_CACHE");
    folder_ = cache != nullptr ? cache : VISMAT_TEST_DATA "/../../cache/levels";
    if (!std::filesystem::is_directory(folder_))
      GTEST_SKIP() << "no levels in " << folder_ << "; ./fetch-levels fetches them";
  }
  std::string file(const char* inside) const {
    const auto path = folder_ / inside;
    return std::filesystem::exists(path) ? path.string() : "";
  }
  std::filesystem::path folder_;
};

constexpr const char* openarena = "openarena-081-maps/usr/share/games/openarena/baseoa/pak1-maps.pk3";
constexpr const char* freedoom = "freedoom/usr/share/games/doom/freedoom2.wad";

std::vector<std::uint8_t> byte_rows(const VisibilityMatrix& matrix) {
  const std::size_t row_bytes = (matrix.shape().columns + 7) / 8;
  std::vector<std::uint8_t> bytes(matrix.shape().rows * row_bytes, 0);
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    for (const std::uint32_t c : matrix.row(r))
      bytes[r * row_bytes + c / 8] |= static_cast<std::uint8_t>(1 << c % 8);
  }
  return bytes;
}

// Quake's: a zero byte is followed by how many there are, up to 255; rows apart.
std::size_t run_length_size(const VisibilityMatrix& matrix) {
  const auto bytes = byte_rows(matrix);
  const std::size_t row_bytes = (matrix.shape().columns + 7) / 8;
  std::size_t size = 0;
  for (std::size_t row = 0; row < bytes.size(); row += row_bytes) {
    for (std::size_t i = 0; i < row_bytes;) {
      if (bytes[row + i++] != 0) {
        ++size;
        continue;
      }
      size += 2;
      for (int run = 1; i < row_bytes && run < 255 && bytes[row + i] == 0; ++run) ++i;
    }
  }
  return size;
}

std::size_t gzip_size(const std::vector<std::uint8_t>& bytes) {
  const auto path = std::filesystem::temp_directory_path() / ("vismat-gzip-" + std::to_string(::getpid()));
  std::FILE* pipe = ::popen(("gzip -9 -n > '" + path.string() + "'").c_str(), "w");
  std::fwrite(bytes.data(), 1, bytes.size(), pipe);
  EXPECT_EQ(::pclose(pipe), 0);
  const auto size = std::filesystem::file_size(path);
  std::filesystem::remove(path);
  return size;
}

TEST_F(RealLevels, Koth1HasItsKnownSizes) {
  const std::string pk3 = file(openarena);
  if (pk3.empty()) GTEST_SKIP() << "openarena-081-maps is not there; ./fetch-levels fetches it";
  const Level level = read_level(pk3 + ":maps/oa_koth1.bsp");
  EXPECT_EQ(level.cells.shape(), (Shape{2415, 2415}));
  EXPECT_NEAR(level.cells.density(), 0.169, 0.0005);
  EXPECT_EQ(byte_rows(level.cells).size(), 729330u);
  EXPECT_EQ(run_length_size(level.cells), 353625u);
  EXPECT_EQ(gzip_size(byte_rows(level.cells)), 104402u);
  const VisibilityMatrix faces = face_visibility(level);
  EXPECT_EQ(faces.shape(), (Shape{2415, 2200}));
  EXPECT_EQ(byte_rows(faces).size(), 664125u);
}

TEST_F(RealLevels, OpenArenaIsReadWhole) {
  const std::string pk3 = file(openarena);
  if (pk3.empty()) GTEST_SKIP() << "openarena-081-maps is not there; ./fetch-levels fetches it";
  const auto listing = list_levels(pk3);
  EXPECT_EQ(listing.size(), 50u);
  for (const LevelListing& map : listing) {
    SCOPED_TRACE(map.where);
    if (map.where.ends_with("oa_ctf2.bsp")) {  // the one that was compiled without
      EXPECT_THROW(read_level(map.where), std::runtime_error);
      continue;
    }
    const Level level = read_level(map.where);
    const Dataset cells = level_dataset(level, LevelMatrix::cells, LevelTree::level);
    for (std::uint32_t c = 0; c < cells.matrix.shape().rows; ++c) EXPECT_TRUE(cells.matrix.contains(c, c));
    EXPECT_EQ(transpose(level.cell_neighbours), level.cell_neighbours);
    std::vector<bool> held(level.face_ids.size(), false);
    for (const std::uint32_t face : level.face_tree.object_of_node()) {
      if (face == ObjectTree::none) continue;
      EXPECT_FALSE(held[face]);
      held[face] = true;
    }
    EXPECT_EQ(std::count(held.begin(), held.end(), false), 0);
    EXPECT_TRUE(is_monotone(over_nodes(cells).matrix, *cells.source.tree));
  }
}

TEST_F(RealLevels, FreedoomsRejectTablesAreBuilt) {
  const std::string wad = file(freedoom);
  if (wad.empty()) GTEST_SKIP() << "freedoom is not there; ./fetch-levels fetches it";
  const auto listing = list_levels(wad);
  EXPECT_EQ(listing.size(), 32u);
  for (const LevelListing& map : listing) {
    SCOPED_TRACE(map.where);
    const Level level = read_level(map.where);
    EXPECT_LT(level.cells.density(), 0.6);
    EXPECT_EQ(transpose(level.cells), level.cells);
    for (std::uint32_t s = 0; s < level.cells.shape().rows; ++s) EXPECT_TRUE(level.cells.contains(s, s));
    EXPECT_GT(level.cell_tree.size(), level.cells.shape().rows);
  }
}

}  // namespace
}  // namespace vismat
