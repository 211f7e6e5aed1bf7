// Makes triangles from the faces of a Quake 3 level.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "matrix/box.h"
#include "visibility/levels/level.h"
#include "visibility/levels/quake3_lumps.h"
#include "visibility/scene.h"

namespace vismat::quake3 {

/// A scene to which each call of add() adds one face, which becomes one object. Throws FormatError for lumps that do
/// not fit together.
class FaceGeometry {
 public:
  FaceGeometry(const Lumps& lumps, const std::set<std::string>& see_through_shaders);
  /// Adds a face's triangles, in metres, and returns their box. Faces that players only bump into, and those of unknown
  /// kinds, add no triangles to the scene.
  Box add(const Face& face, std::size_t number);
  const FacesWithoutTriangles& without_triangles() const { return without_triangles_; }
  Scene take();

 private:
  [[noreturn]] void refuse_not_finite(std::size_t vertex) const;
  Shader shader_of(const Face& face, std::size_t number) const;
  /// The corners in metres; those that are not finite may stand in the file as long as no triangle uses them.
  std::vector<glm::vec3> corners_of(const Face& face, std::size_t number) const;
  void add_triangles(const Face& face, std::size_t number, std::span<const glm::vec3> corners);
  void add_patch(const Face& face, std::size_t number, std::span<const glm::vec3> control);

  std::vector<Shader> shaders_;
  std::vector<Vertex> vertices_;
  std::vector<std::int32_t> meshverts_;
  Scene scene_;
  FacesWithoutTriangles without_triangles_;
};

}  // namespace vismat::quake3
