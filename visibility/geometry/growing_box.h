// A box that grows by points.
#pragma once
#include <algorithm>
#include <glm/vec3.hpp>

#include "matrix/box.h"

namespace vismat {

class GrowingBox {
 public:
  void add(const glm::vec3& point) {
    for (int k = 0; k < 3; ++k) {
      box_.low[k] = empty_ ? point[k] : std::min(box_.low[k], point[k]);
      box_.high[k] = empty_ ? point[k] : std::max(box_.high[k], point[k]);
    }
    empty_ = false;
  }
  const Box& box() const { return box_; }  // [0, 0] while nothing was added

 private:
  Box box_;
  bool empty_ = true;
};

}  // namespace vismat
