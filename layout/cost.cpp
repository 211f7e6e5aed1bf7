#include "layout/cost.h"

namespace vismat {

std::uint64_t count_runs(const VisibilityMatrix& matrix) {
  std::uint64_t runs = 0;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto ids = matrix.row(r);
    for (std::size_t i = 0; i < ids.size(); ++i) runs += i == 0 || ids[i] != ids[i - 1] + 1;
  }
  return runs;
}

}  // namespace vismat
