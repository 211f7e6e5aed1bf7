// Makes coarser versions of a scene's objects, and finds how coarse they may be for a view cell.
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
  /// An upper bound on the distance between the original surface and this one, in both directions, rims of open
  /// surfaces included: there is a map from all of the original surface onto all of this one, rim onto rim, that moves
  /// no point farther.
  double error = 0;                                     // metres
  std::vector<std::array<std::uint32_t, 3>> triangles;  // over the mesh's own vertices
};

/// The versions of the mesh, made by edge collapse [Chhugani et al. 2005, section 4]. The first is the mesh itself;
/// each of the others has about half the triangles of the one before, and a larger error. Ends when half cannot be
/// reached. Non-manifold sides are separated first; if the result is still no manifold, there is only the first level.
/// Deterministic. O(n log n).
std::vector<LevelOfDetail> levels_of_detail(const Mesh& mesh);

/// The screen for which errors are measured.
struct Screen {
  std::uint32_t width = 1920, height = 1080;  // pixels
  float field_of_view = 90;                   // degrees, along the width; below 180
};
/// The most pixels that an angle of one radian takes anywhere in the picture, which is in its corners. Throws
/// std::invalid_argument for a screen without pixels or a field of view out of range.
double pixels_per_radian(const Screen& screen);

/// The most pixels by which an error moves a point that stays within `object`, for a viewer anywhere in `cell`; 0 for
/// no error, infinity if viewer and point may meet. Rounded up.
double deviation_in_pixels(double error, const Box& cell, const Box& object, double per_radian);

/// All levels of detail of all objects of a scene, and which of them is drawn from where.
class LevelsOfDetail {
 public:
  /// Throws std::invalid_argument as pixels_per_radian does. `threads` of 0 is one for each core; the result is the
  /// same for any number.
  explicit LevelsOfDetail(const Scene& scene, const Screen& screen = {}, unsigned threads = 0,
                          const Progress& progress = {});
  ~LevelsOfDetail();
  LevelsOfDetail(LevelsOfDetail&&) noexcept;
  LevelsOfDetail& operator=(LevelsOfDetail&&) noexcept;

  std::uint32_t object_count() const;
  const Mesh& mesh(std::uint32_t object) const;
  std::span<const LevelOfDetail> levels(std::uint32_t object) const;
  /// The coarsest level that deviates by less than a pixel, seen from anywhere in the cell [Chhugani et al. 2005,
  /// section 4]; 0 if the cell touches the object's box.
  std::uint32_t level_for(const Box& cell, std::uint32_t object) const;
  /// level_for() of every object.
  std::vector<std::uint32_t> levels_for(const Box& cell) const;
  /// How many of the object's triangles at that level may face some point of the cell. All count if the object is not
  /// closed, or the cell touches its box; of a closed object that has triangles there is always one [docs/visibility.md].
  std::uint64_t facing_triangles(const Box& cell, std::uint32_t object, std::uint32_t level) const;
  /// How many triangles are drawn from the cell: for each of the objects the facing_triangles() of its level.
  std::uint64_t visible_triangles(const Box& cell, std::span<const std::uint32_t> objects) const;

 private:
  struct Object;
  double per_radian_;
  std::vector<Object> objects_;
};

}  // namespace vismat
