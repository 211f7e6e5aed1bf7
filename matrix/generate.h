// Generates random matrices that resemble those of large scenes, at the sizes of the published ones.
#pragma once
#include <cstdint>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// The parameters of a matrix of differences on a square grid of view cells. Its rows are the boundaries between
/// neighbouring view cells, its columns objects: row r holds the objects that appear or vanish as a viewer crosses
/// boundary r [Chhugani et al. 2005].
struct DeltaSceneOptions {
  Shape shape{350000, 400000};
  double ones_per_column = 1300;  // on average; met within 2 % where the grid has room for it
  std::uint32_t sites = 5440;     // places where objects stand together
  double crowd_tail = 1.5;        // Pareto exponent of the number of objects at a site: less is more uneven
  double range_tail = 3;          // Pareto exponent of how far a site is seen: less is more uneven
  double private_view = .05;      // share of an object's lines of sight that are its own, not its site's
  std::uint64_t seed = 1;
};

/// The matrix. It is coherent among the objects of a site and incoherent between sites, and its columns are numbered at
/// random, so that its natural order helps no method. The same options give the same matrix with any number of threads.
/// O(ones); takes twice the memory of the result. Throws std::invalid_argument unless shares lie in [0, 1], tails are
/// above .5, ones_per_column is above 0 and there is a site.
VisibilityMatrix generate_delta_scene(const DeltaSceneOptions& options, unsigned threads = 0);

/// The two scenes of Chhugani et al. 2005, section 6.1, made smaller by `scale` in (0, 1]: there are so many times
/// fewer boundaries, objects and sites. A column has sqrt(scale) of the ones, as the rim of a region grows like the
/// root of its area. The source file says how the scenes were calibrated. `harder` makes a less redundant one.
DeltaSceneOptions power_plant_scene(double scale, bool harder = false);
DeltaSceneOptions city_scene(double scale, bool harder = false);

}  // namespace vismat
