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
  std::uint32_t resolution = 32;  // squares along a side of the cube maps, a multiple of 4
  std::uint64_t rays = 20'000;    // aimed rays at most, for each cell and round
  std::uint32_t rounds = 16;      // at most, 1 or more
  float enough_yield = 0.005f;    // a round that adds less than this share of all that is seen is the last
  std::uint64_t seed = 1;
};

/// Casts rays from all cells; fills seen, lines, degree and rays. The first round casts cube maps from nine points of
/// each cell. Each round casts rays that are aimed at what is not seen yet, in later rounds first at what the cell's
/// neighbours see. Each new sight line is extended backwards to whatever stops it, and is given to all cells that it
/// crosses. `not_hidden`, a matrix of cells x objects, spares the search for objects that are proven hidden. Throws
/// std::invalid_argument for options out of range and a `not_hidden` of another shape. The same arguments give the same
/// bytes with any JobRunner. Takes more rays where thousands of small objects are seen at once.
///
/// The degree of visibility of an object from a cell is the largest share of all directions, 4 pi, in which it is the
/// first thing seen (for see-through objects: seen at all) from any of nine points: the cell's centre, and its vertices
/// moved a sixteenth of the way towards it. Each direction stands for a square of a cube map and counts with its solid
/// angle. Objects seen only from other points get half of the smallest square's solid angle, so the degree is always
/// above 0.
Sight see_by_sampling(const AimedRays& rays, const ViewCells& cells, const SampledOptions& options,
                      JobRunner& runner, const Progress& progress = {},
                      const VisibilityMatrix* not_hidden = nullptr);
Sight see_by_sampling(const Scene& scene, const ViewCells& cells, const SampledOptions& options,
                      JobRunner& runner, const Progress& progress = {},
                      const VisibilityMatrix* not_hidden = nullptr);

/// What is seen from one cell: objects ascending, each with its degree of visibility; and the number of rays.
struct SeenFromCell {
  std::vector<SeenObject> objects;
  std::vector<float> degree;
  std::uint64_t rays = 0;
};
/// The first round of see_by_sampling() for one cell alone, without lines of other cells. Aims at `targets` (ascending);
/// cube maps find other objects as well.
SeenFromCell see_from_cell(const AimedRays& rays, const CellPoints& cell,
                           std::span<const std::uint32_t> targets, const SampledOptions& options,
                           Random random);

/// The options in one line that names every parameter.
std::string describe(const SampledOptions& options);

/// For each cell, casts `rays_a_cell` rays in random directions and as many at random objects, and counts what they see
/// that is not listed. missed_rays / rays estimates the pixel error: the share of the view that shows what is not
/// listed. missed_objects / objects estimates the share of missed objects among those that are about as easy to see as
/// what these rays find.
std::vector<HeldBack> held_back_error(const AimedRays& rays, const ViewCells& cells,
                                      const VisibilityMatrix& seen, std::uint32_t rays_a_cell,
                                      std::uint64_t seed, JobRunner& runner, const Progress& progress = {});
/// The upper end of the one-sided confidence interval for a probability, if `missed` of `of` independent trials came
/// true [Clopper and Pearson 1934]; 1 without trials.
double missed_at_most(std::uint64_t missed, std::uint64_t of, double confidence = 0.95);

/// What producers are measured by, with a row for each of the cells `ids`: what is seen by cube maps of 6 x 96^2 rays
/// from each vertex of the cell and 40 random points of its surface, and then by 1500 rays at each object that is not
/// seen yet.
VisibilityMatrix dense_reference(const AimedRays& rays, const ViewCells& cells,
                                 std::span<const std::uint32_t> ids, JobRunner& runner,
                                 const Progress& progress = {});

}  // namespace vismat
