// ALGORITHM. Objects are visited front to back over a tree of boxes; what the shadows drawn so far do not hide draws its own
// occluders, each clipped to the frustum that makes its shadow hold for all of the cell [Chhugani et al. 2005, section 5.2;
// the proof that any point of the cell may be the projection point, and what the shrunk occluder's depths mean, is in
// docs/visibility.md]. What is hidden draws nothing: all behind it would be hidden by the same pixels. Objects that were passed
// before a nearer occluder came are looked at once more in the end.
//
// A pixel's proof is a single occluder. Two that hide an object only together are found from parts of the cell: every
// sight line leaves the cell through its surface, so what is hidden from each patch of it is hidden from the cell.
// Patches are halved, level by level, as long as candidates are left and views allowed; only faces that an object lies
// beyond matter to it, and only that part of it. Tried and found worse: shadows from the patches' corners too, which
// take as long as two or three times the patches and decide less.
#include "visibility/shadows/shadow.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "visibility/geometry/bounding_volume_tree.h"
#include "visibility/geometry/point_bounds.h"
#include "visibility/shadows/shadow_buffer.h"

namespace vismat {
namespace {

using Objects = std::vector<std::uint32_t>;

double squared_distance(const Box& box, const glm::dvec3& point) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double gap = std::max({0.0, box.low[axis] - point[axis], point[axis] - box.high[axis]});
    sum += gap * gap;
  }
  return sum;
}

glm::dvec3 middle(std::span<const glm::dvec3> points) {
  glm::dvec3 sum{};
  for (const glm::dvec3& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

/// The centre, then vertices, then middles of edges and of faces. All lie in the cell.
std::vector<glm::dvec3> projection_points(const Convex& cell, std::uint32_t most) {
  std::vector<glm::dvec3> points = {middle(cell.vertices)};
  points.insert(points.end(), cell.vertices.begin(), cell.vertices.end());
  for (const Convex::Edge& edge : cell.edges) {
    points.push_back((cell.vertices[edge.ends[0]] + cell.vertices[edge.ends[1]]) * 0.5);
  }
  for (const Convex::Face& face : cell.faces) {
    glm::dvec3 sum{};
    for (const std::uint16_t corner : face.corners) sum += cell.vertices[corner];
    points.push_back(sum / static_cast<double>(face.corners.size()));
  }
  points.resize(std::min<std::size_t>(points.size(), most));
  return points;
}

double area(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum{};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return glm::length(sum) / 2;
}

/// The part of the box inside of the plane, or a box around it; false if there is none.
bool clip(Box& box, const std::optional<Plane>& plane) {
  if (!plane) return true;
  double most = -plane->offset;
  for (int axis = 0; axis < 3; ++axis)
    most += plane->normal[axis] * (plane->normal[axis] > 0 ? box.high : box.low)[axis];
  if (most < 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(plane->normal[axis]) != 1) continue;
    const auto at =
        static_cast<float>(plane->normal[axis] * plane->offset);  // a coordinate of the cell: exact
    if (plane->normal[axis] > 0) {
      box.low[axis] = std::max(box.low[axis], std::nextafter(at, -INFINITY));
    } else {
      box.high[axis] = std::min(box.high[axis], std::nextafter(at, INFINITY));
    }
  }
  return true;
}

/// Triangles at their longest edge, quadrangles across their longer pair of sides.
std::array<Patch, 2> halves(const Patch& patch) {
  const std::vector<glm::dvec3>& c = patch.corners;
  std::size_t longest = 0;
  double length = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (const double now = glm::distance(c[i], c[(i + 1) % c.size()]); now > length)
      length = now, longest = i;
  }
  const auto at = [&](std::size_t i) { return c[(longest + i) % c.size()]; };
  const glm::dvec3 half = (at(0) + at(1)) * 0.5;
  if (c.size() == 3) return {Patch{{at(0), half, at(2)}, patch.beyond}, {{half, at(1), at(2)}, patch.beyond}};
  const glm::dvec3 across = (at(2) + at(3)) * 0.5;
  return {Patch{{at(0), half, across, at(3)}, patch.beyond}, {{half, at(1), at(2), across}, patch.beyond}};
}

}  // namespace

std::vector<Occluder> occluders_for(const Scene& scene, const ViewCells& cells, OccluderOptions options) {
  const float ground = lowest_point(scene);
  for (const Box& box : cell_bounds(cells)) {
    options.extend_below_ground = options.extend_below_ground && box.low[2] >= ground;
  }
  return find_occluders(scene, options);
}

struct Shadows::Shared {
  std::vector<Occluder> occluders;
  std::vector<std::uint32_t> first_occluder;  // of each object, and the end
  std::vector<Box> bounds;
};

struct Shadows::Data {
  std::shared_ptr<const Shared> all;
  std::vector<std::uint32_t> present;  // ascending; the tree's objects are places in it
  ObjectTree tree;
  std::vector<Box> node_bounds;
  double gap = 0;  // metres by which a cell and a flat occluder must be apart

  Data(std::shared_ptr<const Shared> objects, std::vector<std::uint32_t> those)
      : all(std::move(objects)), present(std::move(those)) {
    std::vector<Box> boxes;
    boxes.reserve(present.size());
    for (const std::uint32_t object : present) boxes.push_back(all->bounds[object]);
    tree = bounding_volume_tree(boxes);
    node_bounds = vismat::node_bounds(tree, boxes);
    double reach = 0;
    if (!node_bounds.empty()) {
      for (int axis = 0; axis < 3; ++axis) {
        reach = std::max(
            {reach, std::abs(double{node_bounds[0].low[axis]}), std::abs(double{node_bounds[0].high[axis]})});
      }
    }
    gap = 1e-9 * (1 + reach);
  }
};

Shadows::Shadows(const Scene& scene, std::vector<Occluder> occluders) {
  auto all = std::make_shared<Shared>();
  all->occluders = std::move(occluders);
  all->first_occluder.assign(std::size_t{scene.object_count} + 1, 0);
  for (const Occluder& occluder : all->occluders) ++all->first_occluder[occluder.object + 1];
  std::partial_sum(all->first_occluder.begin(), all->first_occluder.end(), all->first_occluder.begin());
  all->bounds = object_bounds(scene);
  std::vector<std::uint32_t> present(scene.object_count);
  std::iota(present.begin(), present.end(), 0u);
  data_ = std::make_unique<const Data>(std::move(all), std::move(present));
}
Shadows::Shadows(std::unique_ptr<const Data> data) : data_(std::move(data)) {}
Shadows::~Shadows() = default;
Shadows::Shadows(Shadows&&) noexcept = default;
Shadows& Shadows::operator=(Shadows&&) noexcept = default;

Shadows Shadows::among(std::span<const std::uint32_t> objects) const {
  return Shadows(
      std::make_unique<const Data>(data_->all, std::vector<std::uint32_t>(objects.begin(), objects.end())));
}

std::span<const Occluder> Shadows::occluders() const {
  return data_->all->occluders;
}
std::span<const Box> Shadows::bounds() const {
  return data_->all->bounds;
}
std::unique_ptr<Shadows::View> Shadows::view(const ShadowOptions& options) const {
  return std::make_unique<View>(*data_, options);
}

struct Shadows::View::Work {
  const Data* data;
  ShadowOptions options;
  ShadowBuffer whole, patch;
  struct Drawn {
    std::uint32_t occluder;
    std::size_t first_plane, end_plane;
  };
  std::vector<Drawn> drawn;  // by the last view, nearest first
  std::vector<Plane> planes;
  std::vector<std::pair<double, std::uint32_t>> by_distance;

  /// Adds what was drawn, with its planes, to `drawn`.
  void draw(ShadowBuffer& buffer, const Convex& cell, std::uint32_t object) {
    for (std::uint32_t i = data->all->first_occluder[object]; i < data->all->first_occluder[object + 1];
         ++i) {
      const Occluder& occluder = data->all->occluders[i];
      if (!apart(cell, occluder.shape, data->gap, occluder.flat) || !blocks_from(occluder, cell)) continue;
      const std::size_t first = planes.size();
      supporting_planes(cell, occluder.shape, occluder.flat, planes, first);
      if (buffer.draw(occluder.shape, std::span(planes).subspan(first), i)) {
        drawn.push_back({i, first, planes.size()});
      } else {
        planes.resize(first);
      }
    }
  }
  void begin(ShadowBuffer& buffer, const glm::dvec3& point, bool names) {
    buffer.clear(point, names);
    planes.clear();
    drawn.clear();
  }
  /// From another point of the same cell: only what drew something before, since what is smaller than the cell shrinks to nothing
  /// from each of its points.
  void draw_again(ShadowBuffer& buffer, const glm::dvec3& point) const {
    buffer.clear(point);
    for (const auto& [occluder, first, end] : drawn) {
      buffer.draw(data->all->occluders[occluder].shape, std::span(planes).subspan(first, end - first),
                  occluder);
    }
  }

  std::vector<Shrinkage> shrinking(const Convex& cell, std::span<const std::uint32_t> objects) {
    std::vector<Shrinkage> all;
    std::vector<Plane> bounding;
    for (const std::uint32_t object : objects) {
      for (std::uint32_t i = data->all->first_occluder[object]; i < data->all->first_occluder[object + 1];
           ++i) {
        const Occluder& occluder = data->all->occluders[i];
        if (!apart(cell, occluder.shape, data->gap, occluder.flat)) continue;
        bounding.clear();
        supporting_planes(cell, occluder.shape, occluder.flat, bounding);
        if (const auto shrinks = shrinkage(cell, occluder, bounding)) all.push_back(*shrinks);
      }
    }
    return all;
  }

  /// From `point` of the cell, over the whole scene.
  Objects look_around(const Convex& cell, const glm::dvec3& point, bool names) {
    begin(whole, point, names);
    Objects visible;
    if (data->tree.size() == 0) return visible;
    using Item = std::pair<double, std::uint32_t>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> nodes;
    nodes.emplace(0, 0);
    while (!nodes.empty()) {
      const std::uint32_t node = nodes.top().second;
      nodes.pop();
      if (whole.hides(data->node_bounds[node])) continue;
      if (const std::uint32_t place = data->tree.object_of_node()[node]; place != ObjectTree::none) {
        const std::uint32_t object = data->present[place];
        visible.push_back(object);
        draw(whole, cell, object);
      }
      for (const std::uint32_t child : data->tree.children(node)) {
        nodes.emplace(squared_distance(data->node_bounds[child], point), child);
      }
    }
    std::sort(visible.begin(), visible.end());
    std::erase_if(visible, [&](std::uint32_t object) { return whole.hides(data->all->bounds[object]); });
    return visible;
  }

  /// From `point` of the cell, over some objects: draws them all into the buffer, gives those that are not hidden.
  Objects look_at(ShadowBuffer& buffer, const Convex& cell, const glm::dvec3& point,
                  std::span<const std::uint32_t> objects, bool names) {
    begin(buffer, point, names);
    by_distance.clear();
    for (const std::uint32_t object : objects)
      by_distance.emplace_back(squared_distance(data->all->bounds[object], point), object);
    std::sort(by_distance.begin(), by_distance.end());
    Objects visible;
    for (const auto& [distance, object] : by_distance) {
      if (buffer.hides(data->all->bounds[object])) continue;
      visible.push_back(object);
      draw(buffer, cell, object);
    }
    std::sort(visible.begin(), visible.end());
    std::erase_if(visible, [&](std::uint32_t object) { return buffer.hides(data->all->bounds[object]); });
    return visible;
  }

  /// Objects left in the fewest pieces are the nearest to being decided: takes those as long as their pieces are at most `most`
  /// together, and gives the others.
  template <typename Piece>
  Objects hopeless(const std::vector<Piece>& level, std::size_t most) const {
    if (level.size() <= most) return {};
    std::map<std::uint32_t, std::vector<std::uint32_t>> pieces_of;
    for (std::uint32_t i = 0; i < level.size(); ++i) {
      for (const std::uint32_t object : level[i].left) pieces_of[object].push_back(i);
    }
    std::vector<std::pair<std::size_t, std::uint32_t>> order;
    for (const auto& [object, pieces] : pieces_of) order.emplace_back(pieces.size(), object);
    std::sort(order.begin(), order.end());
    std::vector<char> needed(level.size(), 0);
    Objects rest;
    for (const auto& [count, object] : order) {
      std::size_t more = 0;
      for (const std::uint32_t piece : pieces_of[object]) more += needed[piece] == 0;
      if (more > most) {
        rest.push_back(object);
        continue;
      }
      most -= more;
      for (const std::uint32_t piece : pieces_of[object]) needed[piece] = 1;
    }
    return rest;
  }
  Objects refine(const Convex& cell, std::span<const std::uint32_t> around,
                 std::span<const std::uint32_t> candidates, const Look& look, HiddenWitness* witness);
};

Shadows::View::View(const Data& data, const ShadowOptions& options)
    : work_(new Work{&data,
                     options,
                     ShadowBuffer(options.resolution),
                     ShadowBuffer(options.patch_resolution),
                     {},
                     {},
                     {}}) {}
Shadows::View::~View() = default;

void Shadows::View::turn_to(const Shadows& shadows) {
  work_->data = shadows.data_.get();
}

std::vector<std::uint32_t> Shadows::View::not_hidden(const Convex& cell) {
  std::vector<glm::dvec3> points = projection_points(cell, std::max(1u, work_->options.points));
  Objects left = work_->look_around(cell, points[0], false);
  const ShadowOptions& options = work_->options;
  if (options.only_point) {
    return work_->look_around(cell, options.only_point(cell, work_->shrinking(cell, left)), false);
  }
  if (options.best_point)
    points.push_back(projection_point(cell, work_->shrinking(cell, left), *options.best_point));
  for (std::size_t i = 1; i < points.size(); ++i) {
    work_->draw_again(work_->whole, points[i]);
    std::erase_if(left,
                  [&](std::uint32_t object) { return work_->whole.hides(work_->data->all->bounds[object]); });
  }
  return left;
}

Objects Shadows::View::Work::refine(const Convex& cell, std::span<const std::uint32_t> around,
                                    std::span<const std::uint32_t> candidates, const Look& look,
                                    HiddenWitness* witness) {
  struct Piece {
    Patch patch;
    Objects around, left;
  };
  std::vector<char> open(data->all->bounds.size(), 0);  // may turn out to be hidden
  const Bounds of_cell = bounds_of(cell.vertices);
  for (const std::uint32_t object : candidates)
    open[object] = !meet(of_cell, bounds_of(data->all->bounds[object]));
  const auto close = [&](const Objects& objects) {
    for (const std::uint32_t object : objects) open[object] = 0;
  };
  std::vector<Piece> level;
  for (const Convex::Face& face : cell.faces) {
    Patch patch_of;
    for (const std::uint16_t corner : face.corners) patch_of.corners.push_back(cell.vertices[corner]);
    if (!(area(patch_of.corners) > 0)) continue;
    patch_of.beyond = Plane{face.normal, face.offset};
    Piece piece{std::move(patch_of), {around.begin(), around.end()}, {}};
    for (const std::uint32_t object : candidates) {
      Box box = data->all->bounds[object];
      if (clip(box, piece.patch.beyond)) piece.left.push_back(object);
    }
    level.push_back(std::move(piece));
  }
  if (level.empty())
    return {candidates.begin(), candidates.end()};  // a cell without area is its own only patch

  Objects reached;
  for (std::uint32_t views = 0; !level.empty();) {
    std::vector<Piece> next;
    for (Piece& piece : level) std::erase_if(piece.left, [&](std::uint32_t object) { return !open[object]; });
    std::erase_if(level, [](const Piece& piece) { return piece.left.empty(); });
    close(hopeless(level, (options.patches - views) / 2));  // the other half is for finer patches
    for (Piece& piece : level) {
      std::erase_if(piece.left, [&](std::uint32_t object) { return !open[object]; });
      if (piece.left.empty()) continue;
      if (views == options.patches) {
        close(piece.left);
        continue;
      }
      ++views;
      const Convex plate = convex_plate(piece.patch.corners, piece.patch.beyond->normal);
      const glm::dvec3 point = middle(piece.patch.corners);
      piece.around = look_at(patch, plate, point, piece.around, witness != nullptr);
      Objects left = piece.left;
      std::erase_if(left, [&](std::uint32_t object) {
        Box box = data->all->bounds[object];
        const bool beyond = clip(box, piece.patch.beyond);
        if (beyond && !patch.hides(box)) return false;
        if (witness != nullptr) {
          witness->parts.push_back({piece.patch, point, {}});
          if (beyond) patch.names_before(box, witness->parts.back().occluders);
        }
        return true;
      });
      if (left.empty()) continue;
      if (look) {
        const Objects seen = look(piece.patch, left);
        close(seen);
        reached.insert(reached.end(), seen.begin(), seen.end());
      }
      for (Patch& half : halves(piece.patch)) next.push_back({std::move(half), piece.around, left});
    }
    level = std::move(next);
  }
  std::sort(reached.begin(), reached.end());
  Objects undecided;
  for (const std::uint32_t object : candidates) {
    if (!open[object] && !std::binary_search(reached.begin(), reached.end(), object))
      undecided.push_back(object);
  }
  return undecided;
}

std::vector<std::uint32_t> Shadows::View::refined(const Convex& cell, std::span<const std::uint32_t> around,
                                                  std::span<const std::uint32_t> candidates,
                                                  const Look& look) {
  if (work_->options.patches == 0) return {candidates.begin(), candidates.end()};
  return work_->refine(cell, around, candidates, look, nullptr);
}

HiddenWitness Shadows::View::witness(const Convex& cell, std::uint32_t object) {
  HiddenWitness witness;
  const Box& box = work_->data->all->bounds[object];
  Objects around;
  for (const glm::dvec3& point : projection_points(cell, std::max(1u, work_->options.points))) {
    const Objects now = work_->look_around(cell, point, true);
    if (around.empty()) around = now;
    if (work_->whole.hides(box)) {
      witness.parts.push_back({{cell.vertices, {}}, point, {}});
      work_->whole.names_before(box, witness.parts[0].occluders);
      return witness;
    }
  }
  if (work_->options.patches == 0 ||
      !work_->refine(cell, around, std::span(&object, 1), {}, &witness).empty())
    return {};
  return witness;
}

}  // namespace vismat
