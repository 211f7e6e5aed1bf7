// Images that show, in place of colours, which object each pixel sees; and how far one is from another.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/camera/frustum.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/rays/ray_caster.h"
#include "visibility/scene.h"

namespace vismat {

/// What a pinhole camera sees, row by row from the top left: for each pixel the nearest object in the direction of its
/// middle, and how far away that is.
struct ItemImage {
  static constexpr std::uint32_t background = 0xffffffff;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> object;
  std::vector<float> depth;  // metres, along the ray; infinite for the background
  bool operator==(const ItemImage&) const = default;
};

/// Draws a scene, or some of its objects, into item images. See-through objects are left out. Each pixel is one ray, so
/// that images are exact up to the rounding of floats, and equal on one kind of CPU for any number of threads.
class ItemBuffer {
 public:
  /// Copies the scene's triangles, and keeps which object each belongs to. O(n log n).
  explicit ItemBuffer(const Scene& scene,
                      RayCaster::Preparation preparation = RayCaster::Preparation::fast_rays);

  /// All objects, from the near plane on, `near` metres before the camera. `threads` of 0 is one for each core.
  ItemImage draw(const Pose& pose, const Screen& screen, double near, unsigned threads = 0) const;
  /// Only the objects o with drawn[o] != 0, given what draw() returned for the same view: pixels whose object is
  /// drawn stay as they are, and only for the others a ray is cast again. Throws std::invalid_argument if the image has
  /// another size.
  ItemImage draw_only(std::span<const std::uint8_t> drawn, const ItemImage& all, const Pose& pose,
                      const Screen& screen, double near, unsigned threads = 0) const;

 private:
  void show(ItemImage& image, std::size_t pixel, const Hit& hit, float begins) const;

  RayCaster caster_;
  std::vector<std::uint32_t> object_of_triangle_;
};

/// The pixels of an image that differ from the reference, of the same pose and size.
struct ImageErrors {
  std::uint64_t missing = 0;  // the background or something farther away is shown in place of an object
  std::uint64_t wrong = 0;    // another object is shown that is no farther away
  std::uint64_t extra = 0;    // an object is shown in place of the background
  std::uint64_t all() const { return missing + wrong + extra; }
  bool operator==(const ImageErrors&) const = default;
};
/// Throws std::invalid_argument if the sizes differ.
ImageErrors errors_of(const ItemImage& image, const ItemImage& reference);

/// The pixels of `coarse` whose object does not occur in `fine` within `reach` pixels of `coarse`, where `fine` is the
/// same view with `samples` x `samples` pixels for each pixel of `coarse`. The distance is from the pixel's middle to
/// that of the nearest fine pixel. The background counts as an object. Throws std::invalid_argument if the sizes do not
/// fit. O(pixels of `fine`), and O(reach^2 samples^2) for each pixel that has another object in its own place.
std::uint64_t far_from(const ItemImage& coarse, const ItemImage& fine, std::uint32_t samples, double reach);
/// The reverse: the pixels of `fine` whose object does not occur in `coarse` within `reach` pixels of `coarse`.
std::uint64_t lost_in(const ItemImage& coarse, const ItemImage& fine, std::uint32_t samples, double reach);

}  // namespace vismat
