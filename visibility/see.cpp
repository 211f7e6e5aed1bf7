// ALGORITHM. A cell at a time. The shadows of its first view leave some objects; rays are aimed at those alone, and find most of
// what is seen; what neither proves is looked at from patches of the cell's boundary, with rays from where it may be
// seen. So each method works only where the other gave no answer.
#include "visibility/see.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "matrix/random.h"
#include "visibility/aimed_rays.h"

namespace vismat {
namespace {

using Objects = std::vector<std::uint32_t>;

struct CellSight {
  std::vector<SeenObject> seen;
  Objects not_hidden;
  std::uint64_t rays = 0;
};

class Bounds {
 public:
  Bounds(const Scene& scene, const BoundsOptions& options)
      : options_(options), shadows_(scene, find_occluders(scene, options.occluders)) {
    if (options.rays + options.patch_rays == 0) return;
    caster_.emplace(scene);
    rays_.emplace(scene, *caster_);
  }
  std::unique_ptr<Shadows::View> view() const { return shadows_.view(options_.shadow); }

  CellSight from(const Convex& cell, std::uint32_t number, Shadows::View& view) const {
    CellSight sight;
    Random random(options_.seed, number);
    const auto look = [&](const Convex& from, std::span<const std::uint32_t> objects, std::uint64_t rays) {
      AimedRays::Seen seen = rays_->from(CellPoints(from), objects, rays, Random(random.next()));
      sight.rays += seen.rays;
      Objects found;
      for (const SeenObject& object : seen.objects) found.push_back(object.object);
      sight.seen.insert(sight.seen.end(), seen.objects.begin(), seen.objects.end());
      return found;
    };
    const Objects around = view.not_hidden(cell);
    Objects undecided = around;
    if (options_.rays > 0) {
      const Objects seen = look(cell, around, options_.rays);
      undecided.clear();
      std::set_difference(around.begin(), around.end(), seen.begin(), seen.end(),
                          std::back_inserter(undecided));
    }
    Shadows::View::Look look_from_patch;
    if (options_.patch_rays > 0) {
      look_from_patch = [&](const Patch& patch, std::span<const std::uint32_t> objects) {
        return look(convex_plate(patch.corners, patch.beyond->normal), objects, options_.patch_rays);
      };
    }
    sight.not_hidden = view.refined(cell, around, undecided, look_from_patch);
    std::sort(sight.seen.begin(), sight.seen.end(),
              [](const SeenObject& a, const SeenObject& b) { return a.object < b.object; });
    for (const SeenObject& seen : sight.seen) sight.not_hidden.push_back(seen.object);
    std::sort(sight.not_hidden.begin(), sight.not_hidden.end());
    return sight;
  }

 private:
  const BoundsOptions& options_;
  Shadows shadows_;
  std::optional<RayCaster> caster_;
  std::optional<AimedRays> rays_;
};

}  // namespace

BoundsOptions effort(unsigned level) {
  BoundsOptions options;
  switch (level) {
    case 0:
      options.shadow.resolution = 256;
      break;
    case 1:  // tuned on the dense city: 9 points pay more than patches for their time, 27 no more than 9
      options.shadow.points = 9;
      options.shadow.patches = 48;
      options.rays = 15000;
      options.patch_rays = 200;
      break;
    case 2:
      options.shadow.points = 9;
      options.shadow.patches = 500;
      options.shadow.patch_resolution = 512;
      options.rays = 50000;
      options.patch_rays = 200;
      break;
    default:
      throw std::invalid_argument("effort " + std::to_string(level) + " is none of 0, 1 and 2");
  }
  return options;
}

Sight see_bounds(const Scene& scene, const ViewCells& cells, const BoundsOptions& options, Crew& crew,
                 const Progress& progress) {
  const Bounds bounds(scene, options);
  constexpr std::uint32_t batch = 8;  // cells that share a pair of buffers
  const auto pieces = crew.run(
      "bounds", (cells.count() + batch - 1) / batch,
      [&](std::uint64_t piece) {
        const auto view = bounds.view();
        Crew::Piece bytes;
        const auto end =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(cells.count(), (piece + 1) * batch));
        for (auto cell = static_cast<std::uint32_t>(piece * batch); cell < end; ++cell) {
          const CellSight sight = bounds.from(convex_of(cells, cell), cell, *view);
          put<std::uint32_t>(bytes, sight.not_hidden);
          put<SeenObject>(bytes, sight.seen);
          put<std::uint64_t>(bytes, std::span(&sight.rays, 1));
        }
        return bytes;
      },
      progress);
  Sight sight;
  std::vector<Objects> seen, not_hidden;
  for (const Crew::Piece& piece : pieces) {
    for (std::span<const std::byte> rest = piece; !rest.empty();) {
      not_hidden.push_back(take<std::uint32_t>(rest));
      seen.emplace_back();
      for (const SeenObject& object : take<SeenObject>(rest)) {
        seen.back().push_back(object.object);
        sight.lines.push_back(object.line);
      }
      sight.rays += take<std::uint64_t>(rest).at(0);
    }
  }
  sight.seen = VisibilityMatrix::from_rows(seen, scene.object_count);
  sight.not_hidden = VisibilityMatrix::from_rows(not_hidden, scene.object_count);
  return sight;
}

std::string describe(const BoundsOptions& o) {
  char text[320];
  std::snprintf(text, sizeof text,
                "%s: %u points at %u pixels, at most %u patches at %u pixels, %u boxes and %u polygons an "
                "object, none below %g m%s",
                o.rays + o.patch_rays == 0 ? "shadow" : "sandwich", o.shadow.points, o.shadow.resolution,
                o.shadow.patches, o.shadow.patch_resolution, o.occluders.boxes_per_object,
                o.occluders.polygons_per_object, static_cast<double>(o.occluders.smallest),
                o.occluders.extend_below_ground ? ", solids reach below the ground" : "");
  std::string line = text;
  if (o.rays + o.patch_rays > 0) {
    line += "; " + std::to_string(o.rays) + " rays a cell, " + std::to_string(o.patch_rays) +
            " a patch, seed " + std::to_string(o.seed);
  }
  return line;
}

}  // namespace vismat
