// Finds what view cells see by sampling rays: the result may miss objects and never invents one.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "visibility/jobs/job_runner.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/sight.h"
#include "visibility/view_cells.h"

namespace vismat {

struct SampledOptions {
  std::uint32_t resolution = 32;  // squares a side of the cube maps, a multiple of 4
  std::uint64_t rays = 20'000;    // aimed, at most, a cell and round
  std::uint32_t rounds = 16;      // at most, 1 or more
  float enough_yield = 0.005f;    // a round that adds less than this share of all that is seen is the last
  std::uint64_t seed = 1;
};

/// The aggressive producer: fills seen, lines, degree and rays. Cube maps from nine points of each cell; rays aimed at what
/// they miss; each new sight line, drawn out to what stops it backwards, is given to all cells that it crosses; then the next
/// round, where what the cells next to it see is looked for first. `not_hidden`, cells x objects: objects hidden there for sure
/// are not looked for. Throws std::invalid_argument for options out of range and a not_hidden of another shape. Same arguments,
/// same bytes, whatever the JobRunner. Where thousands of small objects are seen at once it takes more rays.
///
/// degree_of_visibility: of an object from a cell, the greatest share of all directions, 4 pi, in which it is the first
/// thing seen (see-through ones: seen at all) from any of nine points: the cell's centre, and its vertices moved a sixteenth of
/// the way towards it. Each direction stands for a square of a cube map and counts with its solid angle. Above 0: what is seen
/// from elsewhere alone has half of the smallest square.
Sight see_by_sampling(const AimedRays& rays, const ViewCells& cells, const SampledOptions& options,
                      JobRunner& runner, const Progress& progress = {},
                      const VisibilityMatrix* not_hidden = nullptr);
Sight see_by_sampling(const Scene& scene, const ViewCells& cells, const SampledOptions& options,
                      JobRunner& runner, const Progress& progress = {},
                      const VisibilityMatrix* not_hidden = nullptr);

/// One line that names every parameter.
std::string describe(const SampledOptions& options);

/// One for each cell, by 2 * `rays` rays each. missed_rays / rays estimates the pixel error: the share of the view that shows what
/// is not listed; missed_objects / objects the share of objects, of those that are about as easy to see as what these rays find.
std::vector<HeldBack> held_back_error(const AimedRays& rays, const ViewCells& cells,
                                      const VisibilityMatrix& seen, std::uint32_t rays_a_cell,
                                      std::uint64_t seed, JobRunner& runner, const Progress& progress = {});
/// The upper end of the one-sided confidence interval for a probability of which `missed` in `of` independent trials came true
/// [Clopper and Pearson 1934]; 1 without trials.
double missed_at_most(std::uint64_t missed, std::uint64_t of, double confidence = 0.95);

/// What to measure producers by, a row for each of `ids`: cube maps of 6 x 96^2 rays from each vertex of the cell and 40 random
/// points of its boundary, then 1500 rays at each object not seen yet.
VisibilityMatrix dense_reference(const AimedRays& rays, const ViewCells& cells,
                                 std::span<const std::uint32_t> ids, JobRunner& runner,
                                 const Progress& progress = {});

}  // namespace vismat
