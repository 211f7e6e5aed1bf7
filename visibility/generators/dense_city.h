// Generates a city of fine triangles: buildings, some with rooms and furniture, parked cars, and the streets as view cells.
#pragma once
#include <cstdint>
#include <string>

#include "visibility/scene_file.h"

namespace vismat {

/// The parameters of a dense city, in metres. The defaults give 1.24 million triangles in 2752 objects.
struct DenseCityOptions {
  std::uint32_t size = 20;                     // squares along a side, 1 to 256
  float pitch = 20;                            // side of a square
  float street = 4;                            // strip along two sides of each square that stays free
  float smallest_side = 9, largest_side = 14;  // of a building on the ground, each direction on its own
  float lowest = 6, highest = 30;              // heights
  float step = 1.4f;                           // no wall's triangle has a longer leg
  float interiors = 0.08f;                     // share of the buildings with rooms, doors and furniture
  float car_parks = 0.05f;       // share of the squares with four to eight cars instead of a building
  std::uint32_t car_sides = 24;  // points round a car's body, which has about 2 car_sides^2 triangles
  float cell = 4;                // side of a view cell
  float eye_low = 1, eye_high = 2.5f;
  std::uint64_t seed = 1;
};

/// Makes the dense city. Object 0 is the ground, a sheet at z = 0; the others are closed, face outward and follow
/// square by square, along x first. The view cells are the boxes of a grid over the ground that no object enters,
/// ascending by x first, with their neighbours. The same options give the same city. Throws std::invalid_argument for
/// options out of range.
SceneFile make_dense_city(const DenseCityOptions& options = {});

/// The options in one line that names every parameter.
std::string describe(const DenseCityOptions& options);

}  // namespace vismat
