// Makes coarser versions of a scene's objects, and tells how coarse they may be for a view cell.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "matrix/base/parallel.h"
#include "visibility/geometry/mesh.h"
#include "visibility/scene.h"

namespace vismat {

/// One version of an object.
struct LevelOfDetail {
  /// There is a map from all of the original surface onto all of this one, boundary onto boundary, that moves no point
  /// farther; so no point of either lies farther from the other, nor does any point of a boundary from the other's boundary.
  double error = 0;                                     // metres
  std::vector<std::array<std::uint32_t, 3>> triangles;  // over the mesh's own vertices
};

/// By edge collapse [Chhugani et al. 2005, section 4], each about half the triangles of the one before, errors ascending; the
/// first is the mesh itself. Ends where half cannot be reached. Non-manifold sides are parted first; where that does not
/// make a manifold, there is the first level alone. Deterministic. O(n log n).
std::vector<LevelOfDetail> levels_of_detail(const Mesh& mesh);

/// The finest picture that a vLOD is to serve.
struct Screen {
  std::uint32_t width = 1920, height = 1080;  // pixels
  float field_of_view = 90;                   // degrees, along the width; below 180
};
/// The most pixels that an angle of one radian takes anywhere in the picture: that is in its corners. Throws
/// std::invalid_argument for a screen that is none.
double pixels_per_radian(const Screen& screen);

/// The most that an error moves a point that stays within `object`, for a viewer anywhere in `cell`, in pixels; 0 for no
/// error, infinity where viewer and point may meet. Rounded up.
double deviation_in_pixels(double error, const Box& cell, const Box& object, double per_radian);

/// All levels of all objects of a scene, and what of them is drawn from where.
class LevelsOfDetail {
 public:
  /// Throws std::invalid_argument for a screen that is none. threads 0: one a core; the same for any number.
  explicit LevelsOfDetail(const Scene& scene, const Screen& screen = {}, unsigned threads = 0,
                          const Progress& progress = {});
  ~LevelsOfDetail();
  LevelsOfDetail(LevelsOfDetail&&) noexcept;
  LevelsOfDetail& operator=(LevelsOfDetail&&) noexcept;

  const Mesh& mesh(std::uint32_t object) const;
  std::span<const LevelOfDetail> levels(std::uint32_t object) const;
  /// The coarsest level that deviates by less than a pixel from everywhere in the cell [Chhugani et al. 2005, section 4]; 0
  /// where the cell touches the object's box.
  std::uint32_t level_for(const Box& cell, std::uint32_t object) const;
  /// The triangles of a vLOD: for each of the objects the triangles of its level, less those that turn their backs on the
  /// cell if the object is closed and the cell does not touch its box.
  std::uint64_t visible_triangles(const Box& cell, std::span<const std::uint32_t> objects) const;

 private:
  struct Object;
  double per_radian_;
  std::vector<Object> objects_;
};

}  // namespace vismat
