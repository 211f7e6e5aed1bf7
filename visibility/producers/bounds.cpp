// ALGORITHM. The shadows of a cell's first views leave some objects. Rays are aimed at these alone, and find most of
// those that are seen. Objects that neither proves anything about are examined from patches of the cell's surface, with
// rays from patches from which they may be seen. So each method works only where the other gave no answer.
#include "visibility/producers/bounds.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "matrix/base/random.h"
#include "visibility/rays/aimed_rays.h"

namespace vismat {
namespace {

using Objects = std::vector<std::uint32_t>;

/// Calls work(cell, view, piece) for all cells, those of one piece with the same buffers.
template <typename Work>
std::vector<JobRunner::Piece> for_cells(const std::string& stage, const Shadows& shadows,
                                        const ViewCells& cells, const ShadowOptions& options,
                                        JobRunner& runner, const Progress& progress, const Work& work) {
  constexpr std::uint32_t batch = 8;
  return runner.run(
      stage, (cells.count() + batch - 1) / batch,
      [&](std::uint64_t piece) {
        const auto view = shadows.view(options);
        JobRunner::Piece bytes;
        const auto end =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(cells.count(), (piece + 1) * batch));
        for (auto cell = static_cast<std::uint32_t>(piece * batch); cell < end; ++cell)
          work(cell, *view, bytes);
        return bytes;
      },
      progress);
}

std::vector<Objects> lists_of(const std::vector<JobRunner::Piece>& pieces) {
  std::vector<Objects> lists;
  for (const JobRunner::Piece& piece : pieces) {
    for (std::span<const std::byte> rest = piece; !rest.empty();) lists.push_back(take<std::uint32_t>(rest));
  }
  return lists;
}

Objects without(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  Objects rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

VisibilityMatrix united(const VisibilityMatrix& a, const std::vector<Objects>& b) {
  std::vector<Objects> rows(b.size());
  for (std::uint32_t i = 0; i < b.size(); ++i) {
    const auto row = a.row(i);
    std::set_union(row.begin(), row.end(), b[i].begin(), b[i].end(), std::back_inserter(rows[i]));
  }
  return VisibilityMatrix::from_rows(rows, a.shape().columns);
}

/// What rays from patches saw, merged into what is seen.
void add_seen(Sight& sight, const std::vector<std::vector<SeenObject>>& more) {
  float least = 1;
  for (const float degree : sight.degree) least = std::min(least, degree);
  std::vector<Objects> rows(more.size());
  std::vector<SightLine> lines;
  std::vector<float> degree;
  std::size_t entry = 0;
  for (std::uint32_t cell = 0; cell < more.size(); ++cell) {
    auto next = more[cell].begin();
    const auto take_until = [&](std::uint64_t object) {
      for (; next != more[cell].end() && next->object < object; ++next) {
        rows[cell].push_back(next->object);
        lines.push_back(next->line);
        degree.push_back(least);
      }
    };
    for (const std::uint32_t object : sight.seen.row(cell)) {
      take_until(object);
      rows[cell].push_back(object);
      lines.push_back(sight.lines[entry]);
      degree.push_back(sight.degree[entry++]);
    }
    take_until(std::uint64_t{1} << 32);
  }
  sight.seen = VisibilityMatrix::from_rows(rows, sight.seen.shape().columns);
  sight.lines = std::move(lines);
  sight.degree = std::move(degree);
}

}  // namespace

BoundsOptions effort(unsigned level) {
  BoundsOptions options;
  // Tuned on the dense city: 9 points pay more than patches for their time, 27 no more than 9.
  switch (level) {
    case 0:
      options.shadow.points = 9;
      options.shadow.resolution = 256;
      break;
    case 1:
      options.shadow.points = 9;
      options.shadow.patches = 48;
      options.sampled.emplace();
      options.sampled->rays = 5000;
      options.patch_rays = 200;
      break;
    case 2:
      options.shadow.points = 9;
      options.shadow.patches = 600;
      options.sampled.emplace();
      options.patch_rays = 200;
      break;
    default:
      throw std::invalid_argument("effort " + std::to_string(level) + " is none of 0, 1 and 2");
  }
  return options;
}

BoundsOptions bounds_options(const ProducerOptions& options, bool with_rays) {
  BoundsOptions bounds = effort(options.effort.value_or(1));
  const auto set = [](auto& value, const auto& wanted) {
    if (wanted) value = *wanted;
  };
  set(bounds.shadow.points, options.points);
  set(bounds.shadow.patches, options.patches);
  set(bounds.shadow.resolution, options.resolution);
  set(bounds.shadow.patch_resolution, options.patch_resolution);
  if (with_rays) {
    if (!bounds.sampled) bounds.sampled.emplace();
    set(bounds.sampled->rays, options.rays);
    set(bounds.patch_rays, options.patch_rays);
    set(bounds.sampled->seed, options.seed);
  } else {
    bounds.sampled.reset();
    bounds.patch_rays = 0;
  }
  bounds.occluders.threads = options.threads;
  return bounds;
}

Decided decide_by_patches(Shadows::View& view, const AimedRays* rays, const BoundsOptions& options,
                          const Convex& cell, std::uint32_t number, std::span<const std::uint32_t> around,
                          std::span<const std::uint32_t> candidates) {
  const CellPoints whole(cell);
  Decided decided;
  Random random(rays ? options.sampled->seed : 0, number);
  Shadows::View::Look look;
  if (rays && options.patch_rays > 0) {
    look = [&](const Patch& patch, std::span<const std::uint32_t> targets) {
      const CellPoints points(convex_plate(patch.corners, patch.beyond->normal));
      AimedRays::Seen now = rays->from(points, targets, options.patch_rays, Random(random.next()));
      decided.rays += now.rays;
      Objects found;
      for (const SeenObject& object : now.objects) {
        if (!whole.contains(object.line.from)) continue;  // a sloping patch's point, off by its rounding
        found.push_back(object.object);
        decided.seen.push_back(object);
      }
      return found;
    };
  }
  decided.undecided = view.refined(cell, around, candidates, look);
  std::sort(decided.seen.begin(), decided.seen.end(),
            [](const SeenObject& a, const SeenObject& b) { return a.object < b.object; });
  return decided;
}

Sight see_bounds(const Scene& scene, const ViewCells& cells, const BoundsOptions& options, JobRunner& runner,
                 const Stages& stages) {
  const Shadows shadows(scene, occluders_for(scene, cells, options.occluders));
  std::optional<RayCaster> caster;
  std::optional<AimedRays> rays;
  if (options.sampled) {
    caster.emplace(scene);
    rays.emplace(scene, *caster);
  }
  return see_bounds(shadows, rays ? &*rays : nullptr, cells, options, runner, stages);
}

Sight see_bounds(const Shadows& shadows, const AimedRays* rays, const ViewCells& cells,
                 const BoundsOptions& options, JobRunner& runner, const Stages& stages) {
  const auto objects = static_cast<std::uint32_t>(shadows.bounds().size());
  if (!options.sampled) rays = nullptr;
  const std::vector<Objects> around = lists_of(
      for_cells("shadows", shadows, cells, options.shadow, runner, begin_stage(stages, "casting shadows"),
                [&](std::uint32_t cell, Shadows::View& view, JobRunner::Piece& piece) {
                  put<std::uint32_t>(piece, view.not_hidden(convex_of(cells, cell)));
                }));
  Sight sight;
  sight.not_hidden = VisibilityMatrix::from_rows(around, objects);
  sight.seen = VisibilityMatrix::from_rows(std::vector<Objects>(cells.count()), objects);
  if (options.sampled) {
    VisibilityMatrix not_hidden = std::move(sight.not_hidden);
    sight = see_by_sampling(*rays, cells, *options.sampled, runner, begin_stage(stages, "looking around"),
                            &not_hidden);
    sight.not_hidden = std::move(not_hidden);
  }
  if (options.shadow.patches == 0) return sight;

  const auto pieces = for_cells(
      "patches", shadows, cells, options.shadow, runner, begin_stage(stages, "deciding the rest"),
      [&](std::uint32_t cell, Shadows::View& view, JobRunner::Piece& piece) {
        const Decided decided = decide_by_patches(view, rays, options, convex_of(cells, cell), cell,
                                                  around[cell], without(around[cell], sight.seen.row(cell)));
        put<std::uint32_t>(piece, decided.undecided);
        put<SeenObject>(piece, decided.seen);
        put<std::uint64_t>(piece, std::span(&decided.rays, 1));
      });
  std::vector<Objects> undecided;
  std::vector<std::vector<SeenObject>> seen;
  for (const JobRunner::Piece& piece : pieces) {
    for (std::span<const std::byte> rest = piece; !rest.empty();) {
      undecided.push_back(take<std::uint32_t>(rest));
      seen.push_back(take<SeenObject>(rest));
      sight.rays += take<std::uint64_t>(rest).at(0);
    }
  }
  if (rays) add_seen(sight, seen);
  sight.not_hidden = united(sight.seen, undecided);
  return sight;
}

std::string describe(const BoundsOptions& o) {
  char text[320];
  std::snprintf(text, sizeof text,
                "%s: %u points at %u pixels, at most %u patches at %u pixels, %u boxes and %u polygons an "
                "object, none below %g m%s",
                o.sampled ? "sandwich" : "shadow", o.shadow.points, o.shadow.resolution, o.shadow.patches,
                o.shadow.patch_resolution, o.occluders.boxes_per_object, o.occluders.polygons_per_object,
                static_cast<double>(o.occluders.smallest),
                o.occluders.extend_below_ground ? ", solids reach below the ground" : "");
  std::string line = text;
  if (o.sampled) line += "; " + describe(*o.sampled) + ", " + std::to_string(o.patch_rays) + " rays a patch";
  return line;
}

}  // namespace vismat
