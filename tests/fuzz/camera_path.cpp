// Any bytes as a camera path, with either axes: a path whose text is read back bit by bit and whose frames are poses, or FormatError.
#include "runtime/camera/camera_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "matrix/base/byte_reader.h"

namespace {

void require(bool fact) {
  if (!fact) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  const std::string_view text = size == 0 ? "" : std::string_view(reinterpret_cast<const char*>(data), size);
  for (const CameraAxes axes : {CameraAxes::opengl, CameraAxes::tum}) {
    try {
      const CameraPath path = parse_camera_path(text, "fuzz", axes);
      for (const CameraAxes other : {CameraAxes::opengl, CameraAxes::tum}) {
        const CameraPath again = parse_camera_path(to_text(path, other), "again", other);
        require(std::ranges::equal(path.poses(), again.poses()));
      }
      const auto frames = path.frames(17);
      CameraPath{frames};  // refuses what is no pose
      require(frames.size() == 17 && frames.front().time == path.begin() && frames.back().time == path.end());
      for (const Pose& pose : frames) require(std::abs(glm::length(pose.rotation) - 1) < 1e-9);
    } catch (const FormatError& error) {
      require(std::string_view(error.what()).starts_with("fuzz: "));
    }
  }
  return 0;
}
