// The systems without visibility: everything, what the frustum meets, and that at levels of detail.
#include <algorithm>
#include <optional>
#include <utility>

#include "runtime/walks/systems.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> finest(const BakedScene& scene) {
  std::vector<std::uint32_t> versions(scene.object_bounds().size());
  for (std::uint32_t object = 0; object < versions.size(); ++object) {
    versions[object] = scene.first_version(object);
  }
  return versions;
}

class WholeScene : public WalkSystem {
 public:
  WholeScene(const BakedScene& scene, ChunkCache& cache, bool culls, bool levels)
      : scene_(scene), pins_({scene}, cache), finest_(finest(scene)), culls_(culls), levels_(levels) {}

  void make(Frame& frame) override {
    if (levels_ && cell_ != frame.cell) {
      coarsest_ = reference(frame.cell);
      cell_ = frame.cell;
    }
    const std::vector<std::uint32_t>& of_object = levels_ ? coarsest_ : finest_;
    for (std::uint32_t object = 0; object < of_object.size(); ++object) {
      const bool drawn = !culls_ || frame.frustum.meets(scene_.object_bounds()[object]);
      if (drawn && scene_.versions()[of_object[object]].triangles > 0) {
        frame.versions.push_back(of_object[object]);
      }
    }
    chunks_.clear();
    for (const std::uint32_t version : frame.versions)
      chunks_.push_back(WalkChunks{scene_}.geometry(version));
    pins_.become(chunks_);
    frame.wait();
  }

  std::vector<std::uint32_t> reference(std::uint32_t cell) const override {
    return levels_ && cell != FrameRecord::no_cell ? scene_.versions_from(cell) : finest_;
  }

  bool culls() const override { return culls_; }

  std::uint32_t triangles(const Frame& frame, std::size_t i) const override {
    return scene_.versions()[frame.versions[i]].triangles;
  }

 private:
  const BakedScene& scene_;
  Pins pins_;
  std::vector<std::uint32_t> finest_, coarsest_;  // a version for each object
  std::vector<std::uint32_t> chunks_;
  std::optional<std::uint32_t> cell_;
  bool culls_, levels_;
};

}  // namespace

std::unique_ptr<WalkSystem> make_everything(const BakedScene& scene, ChunkCache& cache, const WalkOptions&) {
  return std::make_unique<WholeScene>(scene, cache, false, false);
}
std::unique_ptr<WalkSystem> make_frustum_only(const BakedScene& scene, ChunkCache& cache,
                                              const WalkOptions&) {
  return std::make_unique<WholeScene>(scene, cache, true, false);
}
std::unique_ptr<WalkSystem> make_frustum_and_levels(const BakedScene& scene, ChunkCache& cache,
                                                    const WalkOptions&) {
  return std::make_unique<WholeScene>(scene, cache, true, true);
}

}  // namespace vismat
