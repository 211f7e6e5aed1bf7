// ALGORITHM. Rays of 4 x 4 pixels are one packet of the ray caster. Where the object that a pixel sees is drawn, leaving out others
// changes nothing; so an image of some objects casts only the rays again that would meet what is not drawn, through it.
#include "runtime/images/item_buffer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "matrix/base/parallel.h"

namespace vismat {
namespace {

constexpr std::uint32_t side = 4;  // of a packet
static_assert(side * side == RayCaster::width);

/// The rays of a picture, each from the near plane on.
class Rays {
 public:
  Rays(const Pose& pose, const Screen& screen, double near)
      : rays_(pose, screen),
        eye_(pose.position),
        forward_(pose.rotation * glm::dvec3(0, 0, -1)),
        near_(near) {}
  struct Ray {
    glm::vec3 origin, direction;
    float begins;  // metres from the eye
  };
  Ray operator()(std::uint32_t x, std::uint32_t y) const {
    const glm::dvec3 direction = rays_(x, y);
    const double begins = near_ / glm::dot(direction, forward_);
    return {glm::vec3(eye_ + begins * direction), glm::vec3(direction), static_cast<float>(begins)};
  }

 private:
  PixelRays rays_;
  glm::dvec3 eye_, forward_;
  double near_;
};

void check_sizes(bool fit) {
  if (!fit) throw std::invalid_argument("the two images are not of one size");
}

/// Whether the object occurs in the image in a pixel whose middle is within `reach` of the point, in pixels of the image.
bool occurs(const ItemImage& image, std::uint32_t object, double x, double y, double reach) {
  const auto column = static_cast<std::uint32_t>(x),
             row = static_cast<std::uint32_t>(y);  // of the point's pixel
  if (image.object[std::size_t{row} * image.width + column] == object) return true;
  const auto from = [&](double at) {
    return static_cast<std::uint32_t>(std::max(0.0, std::floor(at - reach - 0.5)));
  };
  const auto to = [&](double at, std::uint32_t end) {
    return static_cast<std::uint32_t>(std::clamp(std::ceil(at + reach + 0.5), 0.0, static_cast<double>(end)));
  };
  for (std::uint32_t j = from(y), end_j = to(y, image.height); j < end_j; ++j) {
    for (std::uint32_t i = from(x), end_i = to(x, image.width); i < end_i; ++i) {
      const double dx = i + 0.5 - x, dy = j + 0.5 - y;
      if (dx * dx + dy * dy <= reach * reach && image.object[std::size_t{j} * image.width + i] == object) {
        return true;
      }
    }
  }
  return false;
}

void check_samples(const ItemImage& coarse, const ItemImage& fine, std::uint32_t samples) {
  check_sizes(samples > 0 && std::uint64_t{coarse.width} * samples == fine.width &&
              std::uint64_t{coarse.height} * samples == fine.height);
}

}  // namespace

ItemBuffer::ItemBuffer(const Scene& scene, RayCaster::Preparation preparation)
    : caster_(scene, preparation), object_of_triangle_(scene.object_of_triangle) {}

void ItemBuffer::show(ItemImage& image, std::size_t pixel, const Hit& hit, float begins) const {
  const bool nothing = hit.triangle == Hit::nothing;
  image.object[pixel] = nothing ? ItemImage::background : object_of_triangle_[hit.triangle];
  image.depth[pixel] = nothing ? std::numeric_limits<float>::infinity() : begins + hit.distance;
}

ItemImage ItemBuffer::draw(const Pose& pose, const Screen& screen, double near, unsigned threads) const {
  const Rays rays(pose, screen, near);
  ItemImage image{screen.width, screen.height, {}, {}};
  image.object.resize(std::size_t{screen.width} * screen.height);
  image.depth.resize(image.object.size());
  parallel_for((screen.height + side - 1) / side, threads, [&](std::uint64_t band) {
    const auto top = static_cast<std::uint32_t>(band) * side;
    for (std::uint32_t left = 0; left < screen.width; left += side) {
      std::array<glm::vec3, RayCaster::width> origins, directions;
      std::array<std::size_t, RayCaster::width> pixel{};
      std::array<float, RayCaster::width> begins{};
      unsigned count = 0;
      for (std::uint32_t y = top; y < std::min(top + side, screen.height); ++y) {
        for (std::uint32_t x = left; x < std::min(left + side, screen.width); ++x) {
          const Rays::Ray ray = rays(x, y);
          origins[count] = ray.origin, directions[count] = ray.direction, begins[count] = ray.begins;
          pixel[count++] = std::size_t{y} * screen.width + x;
        }
      }
      const auto hits = caster_.hits(origins, directions, count, true);
      for (unsigned i = 0; i < count; ++i) show(image, pixel[i], hits[i], begins[i]);
    }
  });
  return image;
}

ItemImage ItemBuffer::draw_only(std::span<const std::uint8_t> drawn, const ItemImage& all, const Pose& pose,
                                const Screen& screen, double near, unsigned threads) const {
  check_sizes(all.width == screen.width && all.height == screen.height);
  const Rays rays(pose, screen, near);
  ItemImage image = all;
  const std::function<bool(std::uint32_t)> shown = [&](std::uint32_t triangle) {
    return drawn[object_of_triangle_[triangle]] != 0;
  };
  parallel_for(screen.height, threads, [&](std::uint64_t y) {
    for (std::uint32_t x = 0; x < screen.width; ++x) {
      const std::size_t pixel = y * screen.width + x;
      const std::uint32_t object = image.object[pixel];
      if (object == ItemImage::background || drawn[object] != 0) continue;
      const Rays::Ray ray = rays(x, static_cast<std::uint32_t>(y));
      show(image, pixel, caster_.hit_of(ray.origin, ray.direction, shown), ray.begins);
    }
  });
  return image;
}

ImageErrors errors_of(const ItemImage& image, const ItemImage& reference) {
  check_sizes(image.width == reference.width && image.height == reference.height);
  ImageErrors errors;
  for (std::size_t i = 0; i < image.object.size(); ++i) {
    if (image.object[i] == reference.object[i]) continue;
    if (reference.object[i] == ItemImage::background) {
      ++errors.extra;
    } else if (image.object[i] == ItemImage::background || image.depth[i] > reference.depth[i]) {
      ++errors.missing;
    } else {
      ++errors.wrong;
    }
  }
  return errors;
}

std::uint64_t far_from(const ItemImage& coarse, const ItemImage& fine, std::uint32_t samples, double reach) {
  check_samples(coarse, fine, samples);
  std::uint64_t far = 0;
  for (std::uint32_t y = 0; y < coarse.height; ++y) {
    for (std::uint32_t x = 0; x < coarse.width; ++x) {
      const std::uint32_t object = coarse.object[std::size_t{y} * coarse.width + x];
      far += !occurs(fine, object, (x + 0.5) * samples, (y + 0.5) * samples, reach * samples);
    }
  }
  return far;
}

std::uint64_t lost_in(const ItemImage& coarse, const ItemImage& fine, std::uint32_t samples, double reach) {
  check_samples(coarse, fine, samples);
  std::uint64_t lost = 0;
  for (std::uint32_t y = 0; y < fine.height; ++y) {
    for (std::uint32_t x = 0; x < fine.width; ++x) {
      const std::uint32_t object = fine.object[std::size_t{y} * fine.width + x];
      lost += !occurs(coarse, object, (x + 0.5) / samples, (y + 0.5) / samples, reach);
    }
  }
  return lost;
}

}  // namespace vismat
