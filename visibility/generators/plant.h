// Generates a chemical plant of tens of thousands of pipes, tanks, vessels, beams, gratings and stairs.
#pragma once
#include <cstdint>
#include <string>

#include "visibility/scene_file.h"

namespace vismat {

/// The parameters of a plant, in metres. The defaults give 30 thousand components of 2 million triangles.
struct PlantOptions {
  /// Bays along a side, 1 to 64. Each has a tank, vessels, or a steel frame with floors.
  std::uint32_t size = 7;
  float bay = 16;                // side of a bay, at least 8; a multiple of 0.8 m is used, the next below
  float height = 12;             // of the space that pipes run through, at least 4
  float pipes = 0.25f;           // share of that space's nodes, 0.8 m apart, that pipes take at most
  std::uint32_t pipe_sides = 8;  // points round a pipe
  float cell = 4;                // side of a view cell
  std::uint64_t seed = 1;
};

/// Makes the plant. Objects are components: a straight piece of pipe, an elbow, a tank, a beam, a panel of grating, a
/// flight of stairs. Each is closed, faces outward and at most touches others; only object 0, the ground, is a sheet.
/// The view cells are cubes all over the plant's bounds that can be reached by a viewer who flies in from outside or
/// above, in Z-order, with their neighbours; a cell may have components in it. The same options give the same plant
/// and, on one kind of CPU, the same cells. Throws std::invalid_argument for options out of range.
SceneFile make_plant(const PlantOptions& options = {}, unsigned threads = 0);

/// The options in one line that names every parameter.
std::string describe(const PlantOptions& options);

}  // namespace vismat
