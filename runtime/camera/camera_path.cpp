// A camera of computer vision (y down, looks along +z) is one of OpenGL turned by 180 degrees about its x. As a quaternion that is
// i, and a product with i or -i only exchanges the four numbers and their signs: files are converted without rounding.
#include "runtime/camera/camera_path.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

constexpr double latest_time = 9e9;     // seconds: what a clock of 64-bit nanoseconds holds
constexpr double farthest_place = 1e9;  // metres, as in scene files

std::string text_of_number(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

double length_of(const glm::dquat& q) {
  return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

/// What is wrong with the pose after those; empty if nothing.
std::string fault_of(const Pose& pose, std::span<const Pose> before, double rounding) {
  if (!(std::abs(pose.time) <= latest_time)) {
    return "time " + text_of_number(pose.time) + " is no number of seconds within 9e9 of 0" +
           (std::abs(pose.time) < 9e18 ? "; are these nanoseconds?" : "");
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(pose.position[axis]) <= farthest_place)) {
      return std::string("xyz").substr(static_cast<std::size_t>(axis), 1) + " " +
             text_of_number(pose.position[axis]) + " is not within 1e9 m of the origin";
    }
  }
  if (!before.empty() && pose.time < before.back().time)
    return "time falls from " + text_of_number(before.back().time) + " to " + text_of_number(pose.time);
  if (const double length = length_of(pose.rotation); !(std::abs(length - 1) <= rounding)) {
    return "the quaternion's length is " + text_of_number(length) + ", not 1" +
           (length == 0 ? "; no rotation is 0 0 0 1" : "");
  }
  return {};
}

glm::dquat from_file(const glm::dquat& q, CameraAxes axes) {
  return axes == CameraAxes::opengl ? q : glm::dquat(-q.x, q.w, q.z, -q.y);  // q i
}

glm::dquat to_file(const glm::dquat& q, CameraAxes axes) {
  return axes == CameraAxes::opengl ? q : glm::dquat(q.x, -q.w, -q.z, q.y);  // -q i
}

}  // namespace

CameraPath::CameraPath(std::vector<Pose> poses) : poses_(std::move(poses)) {
  if (poses_.empty()) throw std::invalid_argument("a camera path without poses");
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (const std::string fault = fault_of(poses_[i], std::span(poses_).first(i), 1e-6); !fault.empty())
      throw std::invalid_argument("pose " + std::to_string(i) + " of a camera path: " + fault);
  }
}

Pose CameraPath::at(double time) const {
  const auto after = std::ranges::upper_bound(poses_, time, {}, &Pose::time);
  Pose pose = after == poses_.begin() ? *after : *(after - 1);
  if (after != poses_.begin() && after != poses_.end() && time > pose.time) {
    const double part = (time - pose.time) / (after->time - pose.time);
    pose.position += (after->position - pose.position) * part;
    pose.rotation = glm::normalize(glm::slerp(pose.rotation, after->rotation, part));
  }
  pose.time = time;
  return pose;
}

std::vector<Pose> CameraPath::frames(std::uint32_t count) const {
  if (count == 0) throw std::invalid_argument("a camera path is shown in one frame at least");
  std::vector<Pose> poses;
  poses.reserve(count);
  for (std::uint32_t f = 0; f < count; ++f) {
    const double part = count == 1 ? 0 : static_cast<double>(f) / (count - 1);
    poses.push_back(at(part == 1 ? end() : begin() + (end() - begin()) * part));
  }
  return poses;
}

CameraPath parse_camera_path(std::string_view bytes, std::string_view name, CameraAxes axes) {
  return naming(std::filesystem::path(name), [&] {
    std::string storage;
    Text text(plain_text(bytes, storage), '#', false);
    std::vector<Pose> poses;
    do {
      std::array<double, 8> numbers{};
      std::size_t count = 0;
      for (std::string_view word; !(word = text.word_of_line()).empty(); ++count) {
        if (count < numbers.size()) numbers[count] = text.number(word, "one of a pose's eight numbers");
      }
      if (count == 0) continue;
      if (count != numbers.size()) {
        text.fail(std::to_string(count) + (count == 1 ? " word" : " words") +
                  "; a pose is eight numbers: t x y z qx qy qz qw");
      }
      const auto& [t, x, y, z, qx, qy, qz, qw] = numbers;
      Pose pose = {t, {x, y, z}, from_file({qw, qx, qy, qz}, axes)};
      if (const std::string fault = fault_of(pose, poses, 0.01); !fault.empty()) text.fail(fault);
      const double length = length_of(pose.rotation);
      if (std::abs(length - 1) > 1e-12) pose.rotation = pose.rotation / length;  // others stay as they are
      poses.push_back(pose);
    } while (text.next_line());
    if (poses.empty()) throw FormatError("holds no pose; each is a line: t x y z qx qy qz qw");
    return CameraPath(std::move(poses));
  });
}

CameraPath read_camera_path(const std::filesystem::path& file, CameraAxes axes) {
  const std::vector<std::byte> bytes = read_file(file);
  return parse_camera_path({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.native(), axes);
}

std::string to_text(const CameraPath& path, CameraAxes axes) {
  std::string text;
  for (const Pose& pose : path.poses()) {
    const glm::dquat q = to_file(pose.rotation, axes);
    const double numbers[] = {pose.time, pose.position.x, pose.position.y, pose.position.z, q.x, q.y, q.z,
                              q.w};
    for (const double& number : numbers) {
      if (&number != numbers) text += ' ';
      text += text_of_number(number);
    }
    text += '\n';
  }
  return text;
}

}  // namespace vismat
