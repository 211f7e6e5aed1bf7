// Which objects each view cell sees, found by casting rays.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "matrix/base/parallel.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

struct RaySamplingOptions {
  std::uint64_t seed = 1;
  unsigned threads = 0;        // 0: one a core
  std::uint32_t passes = 4;    // at most; see enough_yield for the usual end
  std::uint32_t origins = 12;  // viewpoints an edge of a cell and pass; a corner and a cell itself add one
  std::uint32_t directions = 128;  // unaimed directions all around, a viewpoint of the first pass
  float enough_yield = 0.01f;      // a cell rests once a pass adds less than this part of what it sees
};

struct SeenByRays {
  VisibilityMatrix objects;  // view cells x objects; guarantee: aggressive
  std::uint64_t rays = 0;
  std::vector<std::uint32_t> last_yield;  // per cell, what its last pass added; 0: sampling had converged
};

/// Aggressive: every entry is backed by a ray from a point of the cell at eye height, so nothing is invented;
/// slivers may be missed (docs/artificial.md measures how many). Same scene, options and seed, same result
/// for any thread count, on one kind of CPU: Embree picks its code by the instruction set, and a ray that
/// grazes an edge may fall either way. Time is that of the rays, a few million a second and core; memory one
/// list of objects for each edge, corner and cell. Throws std::invalid_argument for options out of range,
/// std::runtime_error if Embree cannot start. Coordinates must be finite.
SeenByRays see_by_rays(const Scene& scene, const ViewCells& cells, const RaySamplingOptions& options = {},
                       const Progress& progress = {});

/// One line that names every parameter but the number of threads, which changes nothing.
std::string describe(const RaySamplingOptions& options);

}  // namespace vismat
