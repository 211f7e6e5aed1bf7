// An axis-aligned box: where a view cell or an object is.
#pragma once
#include <array>

namespace vismat {

/// Axis-aligned, in the scene's units.
struct Box {
  std::array<float, 3> low{}, high{};
  bool operator==(const Box&) const = default;
};

}  // namespace vismat
