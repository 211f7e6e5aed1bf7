// Finds the boxes that overlap a given box, with a uniform grid over the ground plan (the xy-plane).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "matrix/box.h"

namespace vismat {

class PlanBins {
 public:
  /// The boxes are borrowed.
  PlanBins(const std::vector<Box>& boxes, const Box& region)
      : boxes_(boxes), low_{region.low[0], region.low[1]} {
    const double extent = std::max({region.high[0] - region.low[0], region.high[1] - region.low[1], 1e-3f});
    side_ = extent / std::clamp(std::sqrt(static_cast<double>(boxes.size())), 1.0, 2000.0);
    for (;; side_ *= 2) {  // large triangles lie in many bins; not more than eight each on average
      count_ = static_cast<std::uint32_t>(extent / side_) + 1;
      std::uint64_t entries = 0;
      for (const Box& box : boxes) {
        const Range r = range(box);
        entries += std::uint64_t{r.to[0] - r.from[0] + 1} * (r.to[1] - r.from[1] + 1);
      }
      if (entries <= 8 * boxes.size() + 1000 || count_ == 1) break;
    }
    bins_.resize(std::size_t{count_} * count_);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const Range r = range(boxes[i]);
      for (std::uint32_t y = r.from[1]; y <= r.to[1]; ++y) {
        for (std::uint32_t x = r.from[0]; x <= r.to[0]; ++x) bins_[std::size_t{y} * count_ + x].push_back(i);
      }
    }
  }

  /// The numbers of the boxes that meet the box, ascending.
  std::vector<std::uint32_t> meeting(const Box& box) const {
    std::vector<std::uint32_t> found;
    const Range r = range(box);
    for (std::uint32_t y = r.from[1]; y <= r.to[1]; ++y) {
      for (std::uint32_t x = r.from[0]; x <= r.to[0]; ++x) {
        for (const std::uint32_t i : bins_[std::size_t{y} * count_ + x]) {
          if (meet(boxes_[i], box)) found.push_back(i);
        }
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  struct Range {
    std::array<std::uint32_t, 2> from, to;
  };
  Range range(const Box& box) const {
    const auto bin = [&](double x, unsigned axis) {
      return static_cast<std::uint32_t>(std::clamp((x - low_[axis]) / side_, 0.0, count_ - 1.0));
    };
    return {{bin(box.low[0], 0), bin(box.low[1], 1)}, {bin(box.high[0], 0), bin(box.high[1], 1)}};
  }

  const std::vector<Box>& boxes_;
  std::array<double, 2> low_;
  double side_ = 0;
  std::uint32_t count_ = 0;
  std::vector<std::vector<std::uint32_t>> bins_;
};

}  // namespace vismat
