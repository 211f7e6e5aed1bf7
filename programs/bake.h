// Makes the folder that a walk through a scene needs (runtime/walks/baked_scene.h).
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/parallel.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/jobs/job_runner.h"
#include "visibility/producers/producers.h"
#include "visibility/scene_file.h"

namespace vismat {

struct BakeOptions {
  std::filesystem::path folder;
  std::string producer = "shadow";  // one that sees levels of detail
  ProducerOptions visibility;
  Screen screen{640, 360, 90};  // for which levels are chosen
  std::string codec = "rows-quick";
  Stages stages = {};
};

/// What a part of the bake took, and the bytes of its file.
struct BakedPart {
  std::string name;
  double seconds = 0;
  std::uint64_t bytes = 0;
};

/// One line that names whatever the folder depends on; a journal of the visibility belongs to it alone.
std::string describe(const SceneFile& scene, const BakeOptions& options);

/// Bakes the scene, whose view cells are given, into the folder, which is made if it does not exist. A matrix that the
/// same line of describe() has left there is taken; all else is made anew, so that a bake that was stopped gives the
/// same bytes. Throws std::invalid_argument for a producer that cannot see levels, a codec without single rows, and
/// a folder of another scene. Call it on each process of the runner; only the one that leads writes.
std::vector<BakedPart> bake(const SceneFile& scene, const BakeOptions& options, JobRunner& runner);

}  // namespace vismat
