// Boxes without floors, for scenes small enough to know the answer.
#pragma once
#include <array>

#include "visibility/scene.h"

namespace vismat {

/// Object `scene.object_count`: the walls and roof of a box.
inline void add_open_box(Scene& scene, const Box& box) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (unsigned c = 0; c < 8; ++c) {
    scene.vertices.emplace_back((c & 1 ? box.high : box.low)[0], (c & 2 ? box.high : box.low)[1],
                                (c & 4 ? box.high : box.low)[2]);
  }
  for (const auto& [a, b, c, d] :
       {std::array{0u, 1u, 5u, 4u}, std::array{1u, 3u, 7u, 5u}, std::array{3u, 2u, 6u, 7u},
        std::array{2u, 0u, 4u, 6u}, std::array{4u, 5u, 7u, 6u}}) {
    for (const std::uint32_t corner : {a, b, c, a, c, d}) scene.indices.push_back(first + corner);
    scene.object_of_triangle.insert(scene.object_of_triangle.end(), 2, scene.object_count);
  }
  ++scene.object_count;
}

}  // namespace vismat
