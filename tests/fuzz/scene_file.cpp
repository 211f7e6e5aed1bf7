// Scene files: whatever the bytes, read_scene returns a scene that can be written, or throws FormatError.
#include <cstddef>
#include <cstdint>
#include <span>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "tests/matrix/temporary_folder.h"
#include "visibility/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const vismat::TemporaryFolder folder;
  vismat::write_file(folder / "in.h5", std::as_bytes(std::span(data, size)));
  try {
    const vismat::SceneFile scene = vismat::read_scene(folder / "in.h5");
    vismat::object_bounds(scene.scene);
    vismat::cell_bounds(scene.cells);
    for (std::uint32_t cell = 0; cell < scene.cells.count() && cell < 16; ++cell) {
      vismat::convex_of(scene.cells, cell);
    }
    vismat::write_scene(folder / "out.h5", scene);
    vismat::read_scene(folder / "out.h5");
  } catch (const vismat::FormatError&) {
  }
  return 0;
}
