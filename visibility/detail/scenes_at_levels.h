// Scenes whose objects are at levels of detail: one level of each, or all at once.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/source_map.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/scene.h"

namespace vismat {

/// The pairs of an object and a level of detail of it, numbered ascending by object, then by level.
class LevelPairs {
 public:
  explicit LevelPairs(const LevelsOfDetail& levels);
  std::uint32_t count() const { return first_.back(); }
  std::uint32_t number(ObjectLevel pair) const { return first_[pair.object] + pair.level; }
  ObjectLevel operator[](std::uint32_t number) const;  // O(log objects)
  /// The numbers of all objects at these levels, one for each object; ascending.
  std::vector<std::uint32_t> at(std::span<const std::uint32_t> level_of_object) const;

 private:
  std::vector<std::uint32_t> first_;  // of each object, and the end
};

/// The scene with each object at the given level, which has an item for each object: its object numbers, names and
/// see-through objects are those of `scene`, of which `levels` were made; vertices are those that the triangles use.
/// O(triangles).
Scene scene_at(const Scene& scene, const LevelsOfDetail& levels,
               std::span<const std::uint32_t> level_of_object);

/// The scene that has each level of each object at the same time, in the same place: its objects are the pairs, without
/// names. About twice the triangles of `scene`.
Scene scene_of_all_levels(const Scene& scene, const LevelsOfDetail& levels);

}  // namespace vismat
