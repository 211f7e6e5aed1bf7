// The way of a camera through a scene: where it is and where it looks, at any time.
#pragma once
#include <cstdint>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vismat {

/// A camera at a time. It looks along its own -z; its x points right and its y up, as in OpenGL.
struct Pose {
  double time = 0;                  // seconds, within 9e9 of 0
  glm::dvec3 position{};            // metres in the scene, within 1e9 of the origin
  glm::dquat rotation{1, 0, 0, 0};  // of unit length; turns the camera's axes into the scene's
  bool operator==(const Pose&) const = default;
};

/// Poses by time. Between two of them positions are linear in time and rotations turn evenly, the short way. Two poses of the
/// same time are a jump: at exactly that time the later one holds.
class CameraPath {
 public:
  /// Throws std::invalid_argument, naming the pose, if there is none, a number is not finite or out of range, time falls, or
  /// a rotation is not of unit length within 1e-6.
  explicit CameraPath(std::vector<Pose> poses);

  std::span<const Pose> poses() const { return poses_; }  // one at least; borrowed
  double begin() const { return poses_.front().time; }
  double end() const { return poses_.back().time; }
  /// The pose at that time, which is also the time of the result; before the path begins its first pose, after its end the
  /// last. O(log poses).
  Pose at(double time) const;
  /// Exactly `count` poses: number f is the one at f / (count - 1) of the time from begin() to end(), and a single one is the
  /// one at begin(). Throws std::invalid_argument if count is 0.
  std::vector<Pose> frames(std::uint32_t count) const;

 private:
  std::vector<Pose> poses_;
};

/// The axes of the camera in a file. Its quaternions turn them into the scene's in either case, and the scene's own axes stay.
enum class CameraAxes {
  opengl,  // x right, y up, looks along -z: `.path` files of OpenSceneGraph
  tum,  // x right, y down, looks along +z: trajectories of the TUM RGB-D benchmark, and of computer vision in general
};

/// Reads a path of one pose a line: `t x y z qx qy qz qw`, in seconds and metres, with blanks between the numbers. Empty lines
/// and what follows a # are skipped; LF, CR LF and CR end a line. Numbers are decimal with a point, whatever the locale. A
/// quaternion whose length is within 1 % of 1, as that of a file rounded to two digits is, is made of unit length; a length
/// beyond that is no rounding, and is refused. Throws FormatError that begins with `name` and the number of the line, if
/// - a line has not eight numbers, or one is not finite, out of range, or a quaternion of another length, such as 0;
/// - time falls (two lines of the same time are a jump);
/// - there is no pose.
CameraPath parse_camera_path(std::string_view text, std::string_view name,
                             CameraAxes axes = CameraAxes::opengl);
CameraPath read_camera_path(const std::filesystem::path& file, CameraAxes axes = CameraAxes::opengl);

/// A line for each pose, which parse_camera_path reads back bit by bit. No comments: OpenSceneGraph knows none in its files.
std::string to_text(const CameraPath& path, CameraAxes axes = CameraAxes::opengl);

}  // namespace vismat
