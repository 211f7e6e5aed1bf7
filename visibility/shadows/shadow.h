// Finds the objects that are surely hidden from a view cell, by shrunk shadows of single occluders and by the fusion of these over
// patches of the cell's boundary.
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
  std::uint32_t resolution = 512;  // pixels a side of each of six faces
  /// Projection points whose shadows are joined: 1 (the centre), 9 (and the corners), 27 (and middles of edges and faces).
  std::uint32_t points = 1;
  /// One more point, found for the occluders that the first shows.
  std::optional<ProjectionObjective> best_point;
  /// The only point instead, for comparison: given the cell and how the occluders shrink that its centre shows. A point of the cell.
  std::function<glm::dvec3(const Convex&, std::span<const Shrinkage>)> only_point;
  std::uint32_t patches = 0;  // views from patches of the cell's boundary, at most; 0: the whole cell at once
  std::uint32_t patch_resolution = 256;
};

/// A flat piece of a view cell's boundary, or all of the cell.
struct Patch {
  std::vector<glm::dvec3> corners;  // in order around it; of a whole cell: its vertices
  /// Only what lies inside of this plane is looked at through the patch; none: everything is.
  std::optional<Plane> beyond;
};

/// What hides an object from a view cell, for verification.
struct HiddenWitness {
  struct Part {
    Patch patch;
    glm::dvec3 point{};  // of the patch, from where the shadows were cast
    /// Each point of the object beyond the patch lies in the shadow of one of them.
    std::vector<std::uint32_t> occluders;
  };
  std::vector<Part> parts;  // their patches cover all that a sight line from the cell to the object can pass
};

/// find_occluders() for views from these cells: if one of them reaches below the scene, no occluder does.
std::vector<Occluder> occluders_for(const Scene& scene, const ViewCells& cells, OccluderOptions options);

/// The occluders of a scene and the tree over its objects; shared by threads, each with a View of its own.
class Shadows {
 public:
  /// Occluders ascending by object, as find_occluders() gives them.
  Shadows(const Scene& scene, std::vector<Occluder> occluders);
  ~Shadows();

  std::span<const Occluder> occluders() const;
  std::span<const Box> bounds() const;  // of the objects

  /// The buffers of one thread.
  class View;
  std::unique_ptr<View> view(const ShadowOptions& options) const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

class Shadows::View {
 public:
  View(const Data& data, const ShadowOptions& options);
  ~View();

  /// Objects that are not hidden from the convex cell, ascending: conservative. One view from its centre (and more from
  /// other points of it).
  std::vector<std::uint32_t> not_hidden(const Convex& cell);
  /// Casts rays from a patch to objects; gives those that were reached.
  using Look = std::function<std::vector<std::uint32_t>(const Patch&, std::span<const std::uint32_t>)>;
  /// Those of `candidates` (ascending) that are neither hidden nor reached by `look`, ascending: still undecided. Views from
  /// patches of the cell's boundary, at most options.patches, halved where candidates are left: what every patch hides is
  /// hidden, be it by different occluders. `around`: what not_hidden() gave.
  std::vector<std::uint32_t> refined(const Convex& cell, std::span<const std::uint32_t> around,
                                     std::span<const std::uint32_t> candidates, const Look& look = {});
  /// How `object` is hidden from the cell; without parts if it is not.
  HiddenWitness witness(const Convex& cell, std::uint32_t object);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace vismat
