// What the verbs about visibility share: scenes, view cells spread over them, and producers judged by what rays see.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "matrix/base/random.h"
#include "visibility/producers/bounds.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/rays/ray_caster.h"
#include "visibility/scene_file.h"

namespace vismat::bench {

/// Another object of triangles, each three of `corners`.
void add_object(Scene& scene, std::span<const glm::dvec3> corners, std::span<const std::uint32_t> indices);

/// A box, closed and outward oriented; bit k of a corner's number says on which side of axis k it lies.
void add_box(Scene& scene, const std::array<glm::dvec3, 8>& corners);
/// A box round `centre` with its axes scaled and turned.
void add_box(Scene& scene, const glm::dvec3& centre, const std::array<glm::dvec3, 3>& half_axes);

glm::dvec3 in_unit_ball(Random& random);

/// By the name that stands in tables: dense-city, box-city, plant; soup: triangles about 20 m long in a cube of 100 m, each an
/// object; tilted-boxes: boxes of 2 to 12 m that lean every way, on 200 x 200 m. A file (see read_any_scene) gets grid cells of 2 m
/// where it has none.
SceneFile study_scene(const std::string& name);

/// Cells that follow one another, `each` at one place, at places spread evenly over the numbering.
std::vector<ViewCells> places_of(const ViewCells& cells, std::uint32_t places, std::uint32_t each);

/// A way to find what is visible, and what came of it, cell by cell.
struct Run {
  using Objects = std::vector<std::uint32_t>;
  std::string producer, settings;
  bool tells_hidden = false, tells_seen = false;
  std::vector<Objects> not_hidden, seen;
  std::vector<double> ms, wall_ms;  // for a view cell, one number for each place
  double preparing_ms = 0;          // of the whole scene, once
};

/// Some view cells of a scene. Producers run on them one thread at a time; the reference is dense_reference() and all
/// that any producer saw.
class Study {
 public:
  Study(std::string name, const Scene& scene, std::vector<ViewCells> places);

  const Scene& scene() const { return scene_; }
  const AimedRays& rays() const { return rays_; }

  void run(const std::string& producer, const std::string& settings, bool tells_hidden, bool tells_seen,
           const std::function<Sight(const ViewCells&, JobRunner&)>& produce, double preparing_ms = 0);

  static constexpr const char* header =
      "scene,triangles,objects,cells,producer,settings,ms_median,ms_least,ms_most,wall_ms,preparing_ms,not_"
      "hidden,seen,reference,over_estimation,found,undecided,wrongly_hidden\n";
  /// A line for each run. `wrong` grows by how many objects a run hid that a ray reached.
  std::string lines(std::uint64_t& wrong);

 private:
  std::string name_;
  const Scene& scene_;
  std::vector<ViewCells> places_;
  RayCaster caster_;
  AimedRays rays_;
  std::vector<Run> runs_;
};

}  // namespace vismat::bench
