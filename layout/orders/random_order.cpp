#include "layout/orders/random_order.h"

#include <numeric>
#include <utility>
#include <vector>

#include "matrix/base/random.h"

namespace vismat {

Permutation random_order(std::uint32_t size, std::uint64_t seed) {
  std::vector<std::uint32_t> order(size);
  std::iota(order.begin(), order.end(), 0u);
  Random random(seed);
  for (std::uint32_t i = size; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return Permutation::from_old_of_new(std::move(order));
}

std::vector<std::uint32_t> random_sample(std::uint32_t size, std::uint32_t count, Random& random) {
  std::vector<std::uint32_t> sample(size);
  std::iota(sample.begin(), sample.end(), 0u);
  for (std::uint32_t i = 0; i < count; ++i) std::swap(sample[i], sample[i + random.below(size - i)]);
  sample.resize(count);
  return sample;
}

}  // namespace vismat
