#include "visibility/detail/scenes_at_levels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

namespace vismat {
namespace {

/// Adds objects to a scene, with the vertices that they use.
class Collector {
 public:
  Collector(Scene& scene, const LevelsOfDetail& levels) : scene_(scene), levels_(levels) {}

  void add(std::uint32_t object, std::uint32_t level) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    const Mesh& mesh = levels_.mesh(object);
    place_.assign(mesh.vertices.size(), none);
    for (const std::array<std::uint32_t, 3>& triangle : levels_.levels(object)[level].triangles) {
      for (const std::uint32_t vertex : triangle) {
        if (place_[vertex] == none) {
          place_[vertex] = static_cast<std::uint32_t>(scene_.vertices.size());
          scene_.vertices.emplace_back(mesh.vertices[vertex]);  // exact: it was a float
        }
        scene_.indices.push_back(place_[vertex]);
      }
      scene_.object_of_triangle.push_back(scene_.object_count);
    }
    ++scene_.object_count;
  }

 private:
  Scene& scene_;
  const LevelsOfDetail& levels_;
  std::vector<std::uint32_t> place_;
};

}  // namespace

LevelPairs::LevelPairs(const LevelsOfDetail& levels) : first_(std::size_t{levels.object_count()} + 1) {
  for (std::uint32_t object = 0; object < levels.object_count(); ++object) {
    first_[object + 1] = first_[object] + static_cast<std::uint32_t>(levels.levels(object).size());
  }
}

ObjectLevel LevelPairs::operator[](std::uint32_t number) const {
  const auto next = std::upper_bound(first_.begin(), first_.end(), number);
  const auto object = static_cast<std::uint32_t>(next - first_.begin() - 1);
  return {object, number - first_[object]};
}

std::vector<std::uint32_t> LevelPairs::at(std::span<const std::uint32_t> level_of_object) const {
  std::vector<std::uint32_t> pairs(level_of_object.begin(), level_of_object.end());
  for (std::uint32_t object = 0; object < pairs.size(); ++object) pairs[object] += first_[object];
  return pairs;
}

Scene scene_at(const Scene& scene, const LevelsOfDetail& levels,
               std::span<const std::uint32_t> level_of_object) {
  assert(level_of_object.size() == scene.object_count && levels.object_count() == scene.object_count);
  Scene at;
  Collector collector(at, levels);
  for (std::uint32_t object = 0; object < scene.object_count; ++object)
    collector.add(object, level_of_object[object]);
  at.see_through = scene.see_through;
  at.object_names = scene.object_names;
  return at;
}

Scene scene_of_all_levels(const Scene& scene, const LevelsOfDetail& levels) {
  assert(levels.object_count() == scene.object_count);
  Scene all;
  Collector collector(all, levels);
  for (std::uint32_t object = 0; object < scene.object_count; ++object) {
    for (std::uint32_t level = 0; level < levels.levels(object).size(); ++level) {
      collector.add(object, level);
      if (!scene.see_through.empty()) all.see_through.push_back(scene.see_through[object]);
    }
  }
  return all;
}

}  // namespace vismat
