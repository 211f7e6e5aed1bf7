// Finds the objects that are proven hidden from a view cell, by shrunk shadows of single occluders, joined over patches
// of the view cell's surface.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "visibility/shadows/occluders.h"
#include "visibility/shadows/projection_point.h"
#include "visibility/shadows/supporting_planes.h"
#include "visibility/view_cells.h"

namespace vismat {

struct ShadowOptions {
  std::uint32_t resolution = 512;  // pixels along a side of each of six faces
  /// The number of projection points whose shadows are joined: 1 (the centre), 9 (and the corners), or 27 (and the
  /// middles of edges and faces).
  std::uint32_t points = 1;
  /// If given, one more point, which is found for the occluders that the first point shows.
  std::optional<ProjectionObjective> best_point;
  /// If given, the only point instead, for comparison: a point of the cell, chosen from the cell and from how those
  /// occluders shrink that its centre shows.
  std::function<glm::dvec3(const Convex&, std::span<const Shrinkage>)> only_point;
  std::uint32_t patches = 0;  // at most, of the cell's surface; 0: the whole cell at once
  std::uint32_t patch_resolution = 256;
};

/// A flat piece of a view cell's surface, or all of the cell.
struct Patch {
  std::vector<glm::dvec3> corners;  // in order around it; for a whole cell its vertices
  /// Only what lies inside this plane is looked at through the patch; if absent, everything is.
  std::optional<Plane> beyond;
};

/// What hides an object from a view cell, for verification.
struct HiddenWitness {
  struct Part {
    Patch patch;
    glm::dvec3 point{};  // of the patch, from which the shadows were cast
    /// Each point of the object beyond the patch lies in the shadow of one of these occluders.
    std::vector<std::uint32_t> occluders;
  };
  std::vector<Part> parts;  // their patches cover all that a sight line from the cell to the object can pass
};

/// The result of find_occluders() for views from these cells. If a cell reaches below the scene, no occluder does.
std::vector<Occluder> occluders_for(const Scene& scene, const ViewCells& cells, OccluderOptions options);

/// The occluders of a scene and the tree over its objects; shared by threads, each with a View of its own.
class Shadows {
 public:
  /// `occluders` ascend by object, as find_occluders() returns them.
  Shadows(const Scene& scene, std::vector<Occluder> occluders);
  ~Shadows();

  /// The shadows in the scene that has only these objects (ascending, each once) of this one, with the same numbers.
  /// Shares the occluders; takes O(n log^2 n) for a tree over n objects.
  Shadows among(std::span<const std::uint32_t> objects) const;

  std::span<const Occluder> occluders() const;
  std::span<const Box> bounds() const;  // of the objects

  /// The buffers of one thread. The view must not outlive the shadows.
  class View;
  std::unique_ptr<View> view(const ShadowOptions& options) const;

  Shadows(Shadows&&) noexcept;
  Shadows& operator=(Shadows&&) noexcept;

 private:
  struct Shared;
  struct Data;
  explicit Shadows(std::unique_ptr<const Data> data);
  std::unique_ptr<const Data> data_;
};

class Shadows::View {
 public:
  View(const Data& data, const ShadowOptions& options);
  ~View();
  /// From now on looks at these shadows, with the buffers that it has.
  void turn_to(const Shadows& shadows);

  /// The objects that are not hidden from the convex cell, ascending: conservative. Casts one view from its centre (and
  /// more from other points of it).
  std::vector<std::uint32_t> not_hidden(const Convex& cell);
  /// Casts rays from a patch at objects, and returns those that were reached.
  using Look = std::function<std::vector<std::uint32_t>(const Patch&, std::span<const std::uint32_t>)>;
  /// Those of `candidates` (ascending) that are neither hidden nor reached by `look`, and so still undecided;
  /// ascending. Looks from patches of the cell's surface, at most options.patches of them, which are halved where
  /// candidates are left: what is hidden from every patch is hidden, even if by different occluders. `around` is what
  /// not_hidden() returned.
  std::vector<std::uint32_t> refined(const Convex& cell, std::span<const std::uint32_t> around,
                                     std::span<const std::uint32_t> candidates, const Look& look = {});
  /// How `object` is hidden from the cell; has no parts if it is not.
  HiddenWitness witness(const Convex& cell, std::uint32_t object);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace vismat
