// Any bytes as a mesh of any format, told by the first: a scene that can be welded and split, or FormatError; and as a file of
// materials and an image.
#include "visibility/meshes/mesh_file.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "matrix/base/byte_reader.h"
#include "visibility/meshes/components.h"
#include "visibility/meshes/materials.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  if (size == 0) return 0;
  try {
    const auto bytes = std::as_bytes(std::span(data, size).subspan(1));
    Materials materials;
    add_materials(bytes, "no/such/folder", materials);
    has_alpha(bytes, data[0] % 2 == 0 ? "image.tga" : "image.png");
    MeshFile file = parse_mesh(bytes, static_cast<MeshFormat>(data[0] % 4));
    Scene& scene = file.scene;
    if (scene.object_count != file.parts.size() ||
        scene.indices.size() != 3 * scene.object_of_triangle.size())
      std::abort();
    const std::size_t triangles = scene.object_of_triangle.size(), vertices = scene.vertices.size();
    const WeldCounts counts = weld(scene, size % 2 == 0 ? 0.0f : 0.5f);
    if (scene.object_of_triangle.size() + counts.zero_area + counts.duplicates != triangles) std::abort();
    if (scene.vertices.size() + counts.joined != vertices) std::abort();
    split_into_components(scene);
    for (const glm::vec3& v : scene.vertices) {
      if (!(std::abs(v.x) <= 1e9f && std::abs(v.y) <= 1e9f && std::abs(v.z) <= 1e9f)) std::abort();
    }
    for (const std::uint32_t index : scene.indices) {
      if (index >= scene.vertices.size()) std::abort();
    }
    for (const std::uint32_t object : scene.object_of_triangle) {
      if (object >= scene.object_count) std::abort();
    }
    object_bounds(scene);
  } catch (const FormatError&) {
  }
  return 0;
}
