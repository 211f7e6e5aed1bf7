// Where one goes from a view cell to the next.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "matrix/visibility_matrix.h"
#include "visibility/view_cells.h"

namespace vismat {

/// Where a viewer leaves one view cell and where they enter the next: the same point, the middle of what the cells share,
/// except where the next cell begins a step higher or lower, or across a gap of rounding.
struct Passage {
  glm::dvec3 leaves{}, enters{};
};

/// How one crosses from a cell to another. Nothing if they have no point in common (within 1e-7 m) and are not prisms of which
/// a side lies along one of the other in the plan, within 2 mm: of ground that is made of several pieces, the ground cells of
/// make_ground_cells fit together no better, and at a step they do so at different heights. The way back is the same.
std::optional<Passage> passage_between(const ViewCells& cells, std::uint32_t from, std::uint32_t to);

/// The cells' neighbours; if they are not known, the cells whose boxes touch.
VisibilityMatrix cell_neighbours(const ViewCells& cells);

/// The pairs of cells between which a path leads: neighbours with a passage, and if they are neighbours only because their boxes
/// touch, without a step. A symmetric matrix of cells x cells. Takes 0.1 to 0.3 us a passage between boxes or
/// between prisms that share a side; 7 us a passage between prisms whose neighbours are not known.
VisibilityMatrix passages_of(const ViewCells& cells);

}  // namespace vismat
