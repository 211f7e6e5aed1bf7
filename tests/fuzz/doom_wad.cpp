// Every map that any bytes list either is read into parts that agree with one another or raises FormatError.
#include "visibility/levels/doom_wad.h"

#include <cstdint>
#include <cstdlib>

#include "matrix/base/byte_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  const auto wad = std::as_bytes(std::span(data, size));
  try {
    for (const WadMap& map : doom_maps(wad)) {
      const Level level = parse_doom_map(wad, map.name);
      if (level.cell_bounds.size() != level.cells.shape().rows ||
          level.cell_neighbours.shape() != level.cells.shape()) {
        std::abort();
      }
      level_dataset(level, LevelMatrix::cells, LevelTree::bounds);
      if (level.cell_tree.size() > 0) over_nodes(level_dataset(level, LevelMatrix::cells, LevelTree::level));
    }
  } catch (const FormatError&) {
  }
  return 0;
}
