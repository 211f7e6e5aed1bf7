// Generates a city: boxes on a jittered grid, its quadtree, and the ground between the boxes as view cells.
#pragma once
#include <cstdint>
#include <string>

#include "visibility/scene_file.h"

namespace vismat {

/// The parameters of a city, in metres. "Artificial 1" and "artificial 2" of Zach & Karner 2003, section 6, are sizes
/// 32 and 64 with these defaults: what the paper leaves open was tuned until the average visibility over all nodes of
/// the quadtree met its Table 1 for both (docs/artificial.md describes the search).
struct CityOptions {
  std::uint32_t size = 32;                     // boxes along a side: a power of two, 1 to 128
  float pitch = 20;                            // side of the grid square in which each box stands
  float narrowest_street = 4;                  // no two boxes come closer
  float smallest_side = 8, largest_side = 10;  // of a box on the ground, each direction on its own
  float lowest = 6, highest = 24;              // heights
  float jitter = 0.2f;  // 0: box in the middle of its square; 1: anywhere in it that leaves the street free
  float eye_low = 1.6f, eye_high = 1.6f;
  std::uint64_t seed = 1;
};

/// Makes the city. Objects are the boxes in Z-order of their squares. The tree is the quadtree, with each node before
/// its children and these in Z-order (depth first: with that order general compressors come to the paper's sizes,
/// breadth first they do not). The view cells are the constrained Delaunay triangles of the ground rectangle with the
/// boxes cut out (6 size^2 + 2 of them), counter-clockwise, in Z-order of the grid squares of their centroids, with
/// their neighbours. The same options give the same city, for one version of GEOS. Throws std::invalid_argument for
/// options out of range. Takes time quadratic in the number of boxes, since GEOS joins holes.
SceneFile make_city(const CityOptions& options = {});

/// The options in one line that names every parameter.
std::string describe(const CityOptions& options);

}  // namespace vismat
