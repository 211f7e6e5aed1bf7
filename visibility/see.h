// What each view cell of a scene sees, what is surely hidden from it, and what is between.
#pragma once
#include <cstdint>
#include <string>

#include "visibility/crew.h"
#include "visibility/occluders.h"
#include "visibility/shadow.h"
#include "visibility/sight.h"
#include "visibility/view_cells.h"

namespace vismat {

/// shadow: conservative, proves what is hidden. sandwich: besides proves by rays what is seen, and then refines only what is
/// undecided. (The third, sampled, is aggressive and has a header of its own: sampled.h.)
struct BoundsOptions {
  ShadowOptions shadow;
  OccluderOptions occluders;
  std::uint64_t rays = 0;        // a cell, at what its first shadows leave; 0: no object is proven seen
  std::uint64_t patch_rays = 0;  // a patch of its boundary, at what is undecided from there
  std::uint64_t seed = 1;        // of the rays
};

/// Time for accuracy, in three steps: 0 is one shadow view a cell; 1 a sandwich with some patches; 2 one that leaves less
/// than 2 % of the objects undecided in a dense city. Throws std::invalid_argument for others.
BoundsOptions effort(unsigned level);

/// Same scene, cells and options, same result, for any crew, on one kind of CPU.
Sight see_bounds(const Scene& scene, const ViewCells& cells, const BoundsOptions& options, Crew& crew,
                 const Progress& progress = {});

/// One line that names every parameter.
std::string describe(const BoundsOptions& options);

}  // namespace vismat
