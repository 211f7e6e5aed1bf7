#include "visibility/ray_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>
#include <type_traits>

namespace vismat {

struct RayCaster::Embree {
  template <auto release>
  struct Release {
    template <typename Handle>
    void operator()(Handle* handle) const {
      release(handle);
    }
  };
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release<rtcReleaseDevice>> device{rtcNewDevice(nullptr)};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release<rtcReleaseScene>> scene{
      device ? rtcNewScene(device.get()) : nullptr};
};

RayCaster::RayCaster(const Scene& scene) : embree_(std::make_unique<Embree>()) {
  if (!embree_->device) throw std::runtime_error("Embree does not start on this machine");
  rtcSetSceneBuildQuality(embree_->scene.get(), RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(embree_->scene.get(), RTC_SCENE_FLAG_ROBUST);  // no leaks where two triangles meet
  RTCGeometry mesh = rtcNewGeometry(embree_->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto fill = [&](RTCBufferType type, RTCFormat format, std::size_t stride, const void* from,
                        std::size_t count) {
    void* to = rtcSetNewGeometryBuffer(mesh, type, 0, format, stride, count);
    if (to == nullptr) throw std::bad_alloc();
    std::copy_n(static_cast<const std::byte*>(from), stride * count, static_cast<std::byte*>(to));
  };
  if (!scene.indices.empty()) {
    fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 12, scene.vertices.data(), scene.vertices.size());
    fill(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 12, scene.indices.data(), scene.indices.size() / 3);
  }
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(embree_->scene.get(), mesh);
  rtcReleaseGeometry(mesh);
  rtcCommitScene(embree_->scene.get());
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::array<Hit, RayCaster::width> RayCaster::hits(const std::array<glm::vec3, width>& origins,
                                                  const std::array<glm::vec3, width>& directions,
                                                  unsigned count, bool coherent) const {
  alignas(64) std::array<int, width> valid;
  RTCRayHit16 packet;
  for (unsigned i = 0; i < width; ++i) {
    valid[i] = i < count ? -1 : 0;
    packet.ray.org_x[i] = origins[i].x, packet.ray.org_y[i] = origins[i].y,
    packet.ray.org_z[i] = origins[i].z;
    packet.ray.dir_x[i] = directions[i].x, packet.ray.dir_y[i] = directions[i].y,
    packet.ray.dir_z[i] = directions[i].z;
    packet.ray.tnear[i] = 0;
    packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
    packet.ray.time[i] = 0;
    packet.ray.mask[i] = ~0u;
    packet.ray.flags[i] = packet.ray.id[i] = 0;
    packet.hit.geomID[i] = packet.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect16(valid.data(), embree_->scene.get(), &context, &packet);
  std::array<Hit, width> hits;
  static_assert(Hit::nothing == RTC_INVALID_GEOMETRY_ID);
  for (unsigned i = 0; i < count; ++i) hits[i] = {packet.hit.primID[i], packet.ray.tfar[i]};
  return hits;
}

Hit RayCaster::hit(const glm::vec3& origin, const glm::vec3& direction) const {
  return hits({origin}, {direction}, 1, false)[0];
}

}  // namespace vismat
