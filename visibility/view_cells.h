// View cells: the convex regions in which a viewer may stand.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "matrix/dataset.h"
#include "visibility/geometry/convex.h"

namespace vismat {

/// View cells, which are convex and closed: prisms over triangles of the ground, which are numbered first, then boxes.
/// Either may be flat.
struct ViewCells {
  std::vector<glm::vec3> corners;         // 3 for each prism: a viewer stands on the triangle,
  float eye_low = 1.6f, eye_high = 1.6f;  // eyes between these heights above it
  std::vector<Box> boxes;
  std::optional<VisibilityMatrix> neighbours;  // cells x cells: those that share a face
  std::uint32_t prisms() const { return static_cast<std::uint32_t>(corners.size() / 3); }
  std::uint32_t count() const { return prisms() + static_cast<std::uint32_t>(boxes.size()); }
};

/// One box for each cell; that of a prism reaches from the lowest eye to the highest.
std::vector<Box> cell_bounds(const ViewCells& cells);

/// The cell as a solid; a flat one keeps the faces, edges and vertices that fall together.
Convex convex_of(const ViewCells& cells, std::uint32_t cell);

/// The cells, each `factor` times as large about its middle, without neighbours. They show how visibility depends on
/// the size of cells, from cells in the same places. With a factor of at most 1 each lies within the old one, except
/// for rounding.
ViewCells resized(const ViewCells& cells, float factor);

}  // namespace vismat
