// Generates a city: boxes on a jittered grid, its quadtree, and the ground between the boxes as view cells.
#pragma once
#include <cstdint>
#include <string>

#include "visibility/scene_file.h"

namespace vismat {

/// "Artificial 1" and "artificial 2" of Zach & Karner 2003, section 6, are sizes 32 and 64 of these defaults:
/// what the paper leaves open was tuned until the average visibility over all quadtree nodes met its Table 1
/// for both (the search is told in docs/artificial.md). Metres.
struct CityOptions {
  std::uint32_t size = 32;                     // boxes a side: a power of two, 1 to 128
  float pitch = 20;                            // side of the grid square in which each box stands
  float narrowest_street = 4;                  // no two boxes come closer
  float smallest_side = 8, largest_side = 10;  // of a box on the ground, each direction on its own
  float lowest = 6, highest = 24;              // heights
  float jitter = 0.2f;  // 0: box in the middle of its square; 1: anywhere in it that leaves the street free
  float eye_low = 1.6f, eye_high = 1.6f;
  std::uint64_t seed = 1;
};

/// Objects are the boxes in Z-order of their squares; the tree is the quadtree, each node before its children
/// and those in Z-order (depth first: general compressors then come to the paper's sizes, breadth first they
/// do not). The view cells are the constrained Delaunay triangles of the ground rectangle with the boxes cut
/// out (6 size^2 + 2 of them), counter-clockwise, in Z-order of the grid squares of their centroids, with
/// their neighbours. Same options, same city, for one version of GEOS. Throws std::invalid_argument for
/// options out of range. Takes time quadratic in the number of boxes, as GEOS joins holes.
SceneFile make_city(const CityOptions& options = {});

/// One line that names every parameter.
std::string describe(const CityOptions& options);

}  // namespace vismat
