// ALGORITHM. Few objects change their level from one cell to the next, but hardly two cells have all levels in common: each
// sees a scene of its own. What takes long is prepared once for all pairs of an object and a level: occluders, trees for
// rays, points at which rays are aimed. A cell's scene is then put together from its pairs by a tree of boxes over them,
// one for shadows and one for rays, in a few milliseconds. Pairs are the objects of one scene that has all levels at
// once, so that shadows and rays need not know of levels.
#include "visibility/producers/see_levels.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/box.h"
#include "visibility/detail/scenes_at_levels.h"
#include "visibility/geometry/cell_points.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/rays/ray_caster.h"
#include "visibility/rays/sampled.h"
#include "visibility/shadows/shadow.h"

namespace vismat {
namespace {

using Pairs = std::vector<std::uint32_t>;

struct SeenPair {
  SeenObject seen;
  float degree = 0;
};

/// What one cell sees, in numbers of pairs, ascending.
struct OfCell {
  Pairs not_hidden;
  std::vector<SeenPair> seen;
  std::uint64_t rays = 0;
};

/// All that is prepared for all cells.
class AllLevels {
 public:
  AllLevels(const Scene& scene, const LevelsOfDetail& levels, const ViewCells& cells,
            const BoundsOptions& options)
      : levels_(levels),
        cells_(cells),
        options_(options),
        pairs_(levels),
        all_(scene_of_all_levels(scene, levels)),
        shadows_(all_, occluders_for(all_, cells, options.occluders)),
        boxes_of_cells_(cell_bounds(cells)) {
    if (!options.sampled) return;
    casters_.emplace(all_);
    nothing_.emplace(casters_->among({}));
    aims_.emplace(all_, *nothing_);
  }

  const LevelPairs& pairs() const { return pairs_; }
  std::span<const Box> bounds() const { return shadows_.bounds(); }

  /// The buffers of one thread, and the scene of the last cell.
  class Viewer {
   public:
    explicit Viewer(const AllLevels& of) : of_(of), view_(of.shadows_.view(of.options_.shadow)) {}

    OfCell look(std::uint32_t cell) {
      const Box& box = of_.boxes_of_cells_[cell];
      go_to(of_.pairs_.at(of_.levels_.levels_for(box)));
      const Convex convex = convex_of(of_.cells_, cell);
      const BoundsOptions& options = of_.options_;
      const Pairs around = view_->not_hidden(convex);
      Pairs left = around;
      std::erase_if(left, [&](std::uint32_t pair) {
        const auto [object, level] = of_.pairs_[pair];
        return of_.levels_.facing_triangles(box, object, level) == 0;
      });
      OfCell result;
      if (caster_) {
        const SeenFromCell seen = see_from_cell(*rays_, CellPoints(convex), left, *options.sampled,
                                                Random(options.sampled->seed, cell));
        for (std::size_t i = 0; i < seen.objects.size(); ++i)
          result.seen.push_back({seen.objects[i], seen.degree[i]});
        result.rays = seen.rays;
      }
      if (options.shadow.patches > 0) {
        const Pairs candidates = without_seen(left, result.seen);
        Decided decided =
            decide_by_patches(*view_, rays_ ? &*rays_ : nullptr, options, convex, cell, around, candidates);
        result.rays += decided.rays;
        const float least = least_of(result.seen);
        for (const SeenObject& object : decided.seen) result.seen.push_back({object, least});
        std::sort(result.seen.begin(), result.seen.end(), by_pair);
        left = std::move(decided.undecided);
      }
      Pairs seen;
      for (const SeenPair& pair : result.seen) seen.push_back(pair.seen.object);
      std::set_union(left.begin(), left.end(), seen.begin(), seen.end(),
                     std::back_inserter(result.not_hidden));
      return result;
    }

   private:
    static bool by_pair(const SeenPair& a, const SeenPair& b) { return a.seen.object < b.seen.object; }
    static Pairs without_seen(const Pairs& pairs, const std::vector<SeenPair>& seen) {
      Pairs rest;
      for (const std::uint32_t pair : pairs) {
        if (!std::binary_search(seen.begin(), seen.end(), SeenPair{{pair, {}}, 0}, by_pair))
          rest.push_back(pair);
      }
      return rest;
    }
    static float least_of(const std::vector<SeenPair>& seen) {
      float least = 1;
      for (const SeenPair& pair : seen) least = std::min(least, pair.degree);
      return least;
    }

    /// Makes the scene of these pairs, unless the last cell's is the same.
    void go_to(Pairs pairs) {
      if (shadows_ && pairs == here_) return;
      here_ = std::move(pairs);
      shadows_.emplace(of_.shadows_.among(here_));
      view_->turn_to(*shadows_);
      if (!of_.casters_) return;
      rays_.reset();
      caster_.emplace(of_.casters_->among(here_));
      rays_.emplace(of_.aims_->with(*caster_));
    }

    const AllLevels& of_;
    std::unique_ptr<Shadows::View> view_;
    Pairs here_;
    std::optional<Shadows> shadows_;
    std::optional<RayCaster> caster_;
    std::optional<AimedRays> rays_;
  };

 private:
  const LevelsOfDetail& levels_;
  const ViewCells& cells_;
  const BoundsOptions& options_;
  LevelPairs pairs_;
  Scene all_;
  Shadows shadows_;
  std::vector<Box> boxes_of_cells_;
  std::optional<PartCasters> casters_;
  std::optional<RayCaster> nothing_;
  std::optional<AimedRays> aims_;  // casts no ray itself
};

/// Numbers the pairs that are listed anew, in place of their numbers among all.
LevelSight renumbered(const AllLevels& all, std::vector<OfCell> of_cells) {
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> column_of_pair(all.pairs().count(), none);
  for (const OfCell& cell : of_cells) {
    for (const std::uint32_t pair : cell.not_hidden) column_of_pair[pair] = 0;
  }
  LevelSight result;
  for (std::uint32_t pair = 0; pair < column_of_pair.size(); ++pair) {
    if (column_of_pair[pair] == none) continue;
    column_of_pair[pair] = static_cast<std::uint32_t>(result.columns.size());
    result.columns.push_back(all.pairs()[pair]);
    result.column_bounds.push_back(all.bounds()[pair]);
  }
  std::vector<Pairs> not_hidden, seen;
  for (OfCell& cell : of_cells) {
    for (std::uint32_t& pair : cell.not_hidden) pair = column_of_pair[pair];
    not_hidden.push_back(std::move(cell.not_hidden));
    Pairs& row = seen.emplace_back();
    for (const SeenPair& pair : cell.seen) {
      row.push_back(column_of_pair[pair.seen.object]);
      result.sight.lines.push_back(pair.seen.line);
      result.sight.degree.push_back(pair.degree);
    }
    result.sight.rays += cell.rays;
  }
  const auto columns = static_cast<std::uint32_t>(result.columns.size());
  result.sight.not_hidden = VisibilityMatrix::from_rows(not_hidden, columns);
  result.sight.seen = VisibilityMatrix::from_rows(seen, columns);
  return result;
}

}  // namespace

LevelSight see_levels(const Scene& scene, const LevelsOfDetail& levels, const ViewCells& cells,
                      const BoundsOptions& options, JobRunner& runner, const Stages& stages) {
  constexpr std::uint32_t batch = 8;
  const AllLevels all(scene, levels, cells, options);
  const auto pieces = runner.run(
      "levels", (cells.count() + batch - 1) / batch,
      [&](std::uint64_t piece) {
        AllLevels::Viewer viewer(all);
        JobRunner::Piece bytes;
        const auto end =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(cells.count(), (piece + 1) * batch));
        for (auto cell = static_cast<std::uint32_t>(piece * batch); cell < end; ++cell) {
          const OfCell now = viewer.look(cell);
          put<std::uint32_t>(bytes, now.not_hidden);
          put<SeenPair>(bytes, now.seen);
          put<std::uint64_t>(bytes, std::span(&now.rays, 1));
        }
        return bytes;
      },
      begin_stage(stages, "looking at levels of detail"));
  std::vector<OfCell> of_cells;
  for (const JobRunner::Piece& piece : pieces) {
    for (std::span<const std::byte> rest = piece; !rest.empty();) {
      OfCell cell;
      cell.not_hidden = take<std::uint32_t>(rest);
      cell.seen = take<SeenPair>(rest);
      cell.rays = take<std::uint64_t>(rest).at(0);
      of_cells.push_back(std::move(cell));
    }
  }
  return renumbered(all, std::move(of_cells));
}

std::string describe_levels(const BoundsOptions& options, const Screen& screen) {
  char text[120];
  std::snprintf(text, sizeof text, "levels of detail within a pixel of %u x %u, %g degrees wide; ",
                screen.width, screen.height, static_cast<double>(screen.field_of_view));
  BoundsOptions one_round = options;
  if (one_round.sampled) one_round.sampled->rounds = 1;
  return text + describe(one_round);
}

}  // namespace vismat
