#include "cli/summary.h"

#include <algorithm>
#include <array>
#include <vector>

#include "visibility/meshes/level_faces.h"

namespace vismat::cli {

std::string printable(std::string_view text) {
  std::string result(text);
  std::replace_if(
      result.begin(), result.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return result;
}

void line(const char* what, const std::string& value) {
  std::printf("%-16s %s\n", what, printable(value).c_str());
}

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits;
}

std::string plural_of(std::string_view what) {
  const std::size_t noun = std::min(what.find(" at "), what.size());
  return std::string(what.substr(0, noun)) + "s" + std::string(what.substr(noun));
}

std::uint64_t see_through_objects(const Scene& scene) {
  return static_cast<std::uint64_t>(std::count(scene.see_through.begin(), scene.see_through.end(), 1));
}

std::string summary_of(std::span<const Boundary> boundaries) {
  const BoundaryMap map(boundaries);
  const std::size_t from_outside = map.neighbours(Boundary::outside).size();
  return grouped(boundaries.size() - from_outside) + " between " + grouped(map.cells()) + " view cells, " +
         grouped(from_outside) + " from outside";
}

void print_loss(const Loss& loss) {
  line("visible", grouped(loss.visible) + " entries of " + grouped(loss.visible + loss.hidden()));
  line("added", grouped(loss.added) +
                    formatted(" entries: %.3f %% of the visible ones; %.3f %% of the occlusions are lost",
                              100 * loss.added_share(), 100 * loss.lost()));
  if (loss.rows.empty()) return;
  std::vector<double> shares(loss.rows.size());
  for (std::uint32_t r = 0; r < shares.size(); ++r) shares[r] = loss.lost_in(r);
  std::ranges::sort(shares);
  const std::uint32_t worst = loss.worst_row();
  line("lost per cell", formatted("median %.3f %%; at most %.3f %% in 95 %% of the view cells",
                                  100 * shares[shares.size() / 2], 100 * shares[shares.size() * 95 / 100]));
  line("worst view cell", std::to_string(worst) + ": " + grouped(loss.rows[worst].added) +
                              " entries added to " + grouped(loss.rows[worst].visible) +
                              formatted("; %.3f %% of its occlusions are lost", 100 * loss.lost_in(worst)));
}

void print_notes(const AnyScene& scene) {
  const auto left_out = [](const std::string& what) { line("left out", what); };
  for (const std::string& what : scene.left_out) {
    left_out(what.ends_with(" left out") ? what.substr(0, what.size() - 9) : what);
  }
  if (scene.welded.zero_area > 0) left_out(grouped(scene.welded.zero_area) + " triangles without area");
  if (scene.welded.duplicates > 0) left_out(grouped(scene.welded.duplicates) + " duplicate triangles");
  for (const std::string& note : scene.notes) line("note", note);
}

void print_extent(const SceneFile& file) {
  const Scene& scene = file.scene;
  if (scene.object_of_triangle.empty()) return;
  const Box bounds = bounds_of(scene);
  std::string low, high, size;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const char* comma = axis == 0 ? "" : ", ";
    low += comma + formatted("%.10g", bounds.low[axis] + file.origin[axis]);
    high += comma + formatted("%.10g", bounds.high[axis] + file.origin[axis]);
    size += (axis == 0 ? "" : " x ") + formatted("%.4g", double{bounds.high[axis]} - bounds.low[axis]);
  }
  line("bounds", "(" + low + ") to (" + high + ")");
  line("size", size + " m (x, y, z)");
  if (file.origin != std::array<double, 3>{}) {
    line("origin", formatted("(%.10g, %.10g, %.10g)", file.origin[0], file.origin[1], file.origin[2]) +
                       ", which is (0, 0, 0) in the scene file");
  }
  const int up = axis_of_level_faces(scene);
  line("level faces",
       std::string("most look along ") + "xyz"[up] +
           (up == 2 ? ""
                    : std::string("; the scene should have z up") +
                          (up == 1 ? ": vismat scene --up y turns a mesh that has y up" : "")));
}

}  // namespace vismat::cli
