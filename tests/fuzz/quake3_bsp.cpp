// Any bytes either are a level whose parts agree with one another or raise FormatError.
#include "visibility/levels/quake3_bsp.h"

#include <cstdint>
#include <cstdlib>

#include "matrix/base/byte_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  try {
    const Level level =
        parse_quake3_bsp(std::as_bytes(std::span(data, size)), {}, VisibilityData::not_needed);
    const std::uint32_t cells = level.cells.shape().rows;
    const auto faces = static_cast<std::uint32_t>(level.face_ids.size());
    for (const std::uint32_t index : level.face_scene.indices) {
      if (index >= level.face_scene.vertices.size()) std::abort();
    }
    if (level.cell_bounds.size() != cells || level.face_bounds.size() != faces ||
        level.cell_neighbours.shape() != level.cells.shape() || level.cell_tree.object_count() != cells ||
        level.face_tree.object_count() != faces || level.face_scene.object_count != faces ||
        level.face_scene.object_of_triangle.size() * 3 != level.face_scene.indices.size()) {
      std::abort();
    }
    if (!level.has_visibility) return 0;
    level_dataset(level, LevelMatrix::cells, LevelTree::bounds);
    if (faces > 0) over_nodes(level_dataset(level, LevelMatrix::faces, LevelTree::level));
  } catch (const FormatError&) {
  }
  return 0;
}
