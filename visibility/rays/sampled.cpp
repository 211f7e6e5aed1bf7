// ALGORITHM. Sampled visibility in rounds. In the first, cube maps find what is easy (their rays run side by side, up to seven
// times faster than others) and measure the degree of visibility; aimed_rays.h looks for the rest. A sight line found for one
// cell proves as much for every cell that it crosses, drawn out backwards to the first obstacle, as in adaptive global
// visibility sampling [Bittner et al. 2009]. There every ray is kept in mind for all cells; here only the lines to new objects
// are, which are few, so that cells stay independent of one another within a round and results do not depend on who does
// what. From the second round on a cell starts with what its neighbours see and it does not, at the same places.
#include "visibility/rays/sampled.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "matrix/object_tree.h"
#include "visibility/geometry/bounding_volume_tree.h"
#include "visibility/geometry/touching_boxes.h"
#include "visibility/rays/seen_along.h"

namespace vismat {
namespace {

using Packet = std::array<glm::vec3, RayCaster::width>;
constexpr std::uint64_t cells_a_piece = 8;

struct Entry {
  std::uint32_t cell = 0, object = 0;
  SightLine line;
  float degree = 0;  // 0: smaller than what cube maps show
};

bool before(const Entry& a, const Entry& b) {
  return std::pair(a.cell, a.object) < std::pair(b.cell, b.object);
}

/// The squares of one face of a cube map.
struct Squares {
  explicit Squares(std::uint32_t squares_a_side) : side(squares_a_side) {
    double sum = 0;
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        const double u = at(x), v = at(y);
        share.push_back(std::pow(1 + u * u + v * v, -1.5));
        sum += share.back();
      }
    }
    for (double& s : share) s /= 6 * sum;
  }
  float at(std::uint32_t i) const { return (2 * static_cast<float>(i) + 1) / static_cast<float>(side) - 1; }
  /// Of what no square shows.
  float least_degree() const { return static_cast<float>(*std::min_element(share.begin(), share.end()) / 2); }

  std::uint32_t side;
  std::vector<double> share;  // of all directions, row by row
};

/// Cube maps from one cell.
class Look {
 public:
  Look(const AimedRays& rays, const Squares& squares)
      : rays_(rays), squares_(squares), share_(rays.scene().object_count), greatest_(share_.size()) {}

  void from(const glm::vec3& origin) {
    Packet origins, directions;
    origins.fill(origin);
    for (unsigned face = 0; face < 6; ++face) {
      const int axis = static_cast<int>(face / 2);
      for (std::uint32_t y = 0; y < squares_.side; y += 4) {
        for (std::uint32_t x = 0; x < squares_.side; x += 4) {
          for (std::uint32_t i = 0; i < RayCaster::width; ++i) {
            directions[i][axis] = face % 2 == 0 ? -1.0f : 1.0f;
            directions[i][(axis + 1) % 3] = squares_.at(x + i % 4);
            directions[i][(axis + 2) % 3] = squares_.at(y + i / 4);
          }
          std::uint32_t last_ray = RayCaster::width, last_object = 0;
          see_along(rays_.scene(), rays_.caster(), origins, directions, RayCaster::width, true,
                    [&](unsigned ray, std::uint32_t triangle, float distance) {
                      const std::uint32_t object = rays_.scene().object_of_triangle[triangle];
                      if (ray == last_ray && object == last_object) return;  // seen once more, through itself
                      last_ray = ray, last_object = object;
                      if (greatest_[object] == 0 && share_[object] == 0) {
                        seen_.push_back({object, {origin, origin + directions[ray] * distance}});
                      }
                      if (share_[object] == 0) here_.push_back(object);
                      share_[object] += squares_.share[(y + ray / 4) * squares_.side + x + ray % 4];
                    });
        }
      }
    }
    cast_ += std::uint64_t{6} * squares_.side * squares_.side;
    for (const std::uint32_t object : here_) {
      greatest_[object] = std::max(greatest_[object], std::exchange(share_[object], 0));
    }
    here_.clear();
  }
  const std::vector<SeenObject>& seen() const { return seen_; }  // as they came, not confirmed
  float degree(std::uint32_t object) const { return static_cast<float>(greatest_[object]); }
  std::uint64_t cast() const { return cast_; }

 private:
  const AimedRays& rays_;
  const Squares& squares_;
  std::vector<double> share_, greatest_;  // from this point, from any so far
  std::vector<std::uint32_t> here_;
  std::vector<SeenObject> seen_;
  std::uint64_t cast_ = 0;
};

/// The centre, and the vertices a little inwards.
std::vector<glm::vec3> sample_points(const CellPoints& cell) {
  std::vector<glm::vec3> points = {cell.within(cell.centre())};
  for (const glm::dvec3& vertex : cell.cell().vertices) {
    const glm::vec3 point = cell.within(glm::mix(vertex, cell.centre(), 1 / 16.0));
    if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
  }
  return points;
}

/// Which cells a segment may cross.
class CellTree {
 public:
  explicit CellTree(const ViewCells& cells)
      : tree_(bounding_volume_tree(cell_bounds(cells))), bounds_(node_bounds(tree_, cell_bounds(cells))) {}

  /// Calls met(cell) for each whose box from + t * direction, t in [0, limit], meets.
  template <typename Met>
  void along(const glm::dvec3& from, const glm::dvec3& direction, double limit, const Met& met) const {
    if (tree_.size() > 0) along(0, from, direction, limit, met);
  }

 private:
  template <typename Met>
  void along(std::uint32_t node, const glm::dvec3& from, const glm::dvec3& direction, double limit,
             const Met& met) const {
    double first = 0, last = limit;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = bounds_[node].low[static_cast<unsigned>(axis)] - from[axis],
                   high = bounds_[node].high[static_cast<unsigned>(axis)] - from[axis];
      if (direction[axis] == 0) {
        if (low > 0 || high < 0) return;
      } else {
        const auto [in, out] = std::minmax({low / direction[axis], high / direction[axis]});
        first = std::max(first, in), last = std::min(last, out);
      }
    }
    if (!(first <= last)) return;
    if (const std::uint32_t cell = tree_.object_of_node()[node]; cell != ObjectTree::none) met(cell);
    for (const std::uint32_t child : tree_.children(node)) along(child, from, direction, limit, met);
  }

  ObjectTree tree_;
  std::vector<Box> bounds_;
};

/// All that is known so far, and what a round makes of it.
class Rounds {
 public:
  Rounds(const AimedRays& rays, const ViewCells& cells, const SampledOptions& options,
         const VisibilityMatrix* not_hidden, JobRunner& runner)
      : rays_(rays),
        cells_(cells),
        options_(options),
        not_hidden_(not_hidden),
        runner_(runner),
        tree_(cells),
        squares_(options.resolution),
        neighbours_(cells.neighbours ? *cells.neighbours : touching_boxes(cell_bounds(cells))),
        rows_(cells.count()),
        all_(rays.scene().object_count) {
    std::iota(all_.begin(), all_.end(), 0u);
  }

  /// How many entries it added.
  std::uint64_t run(std::uint32_t round, const Progress& progress) {
    const std::string number = std::to_string(round);
    std::vector<Entry> fresh = stage(
        "rays " + number, cells_.count(), cells_a_piece,
        [&](std::uint64_t cell, std::vector<Entry>& found) {
          return look(round, static_cast<std::uint32_t>(cell), found);
        },
        progress);
    add(fresh);
    std::vector<Entry> shared =
        stage("shared lines " + number, fresh.size(), 1024,
              [&](std::uint64_t i, std::vector<Entry>& found) { return share(fresh[i], found); }, {});
    std::stable_sort(shared.begin(), shared.end(), before);
    shared.erase(
        std::unique(shared.begin(), shared.end(),
                    [](const Entry& a, const Entry& b) { return a.cell == b.cell && a.object == b.object; }),
        shared.end());
    add(shared);
    entries_ += fresh.size() + shared.size();
    return fresh.size() + shared.size();
  }
  std::uint64_t entries() const { return entries_; }

  Sight result() const {
    Sight sight;
    const float least = squares_.least_degree();
    std::vector<std::uint64_t> offsets = {0};
    std::vector<std::uint32_t> ids;
    for (const std::vector<Entry>& row : rows_) {
      for (const Entry& entry : row) {
        ids.push_back(entry.object);
        sight.lines.push_back(entry.line);
        sight.degree.push_back(std::max(entry.degree, least));
      }
      offsets.push_back(ids.size());
    }
    sight.seen = VisibilityMatrix::from_csr({cells_.count(), rays_.scene().object_count}, std::move(offsets),
                                            std::move(ids));
    sight.rays = cast_;
    return sight;
  }

 private:
  bool sees(std::uint32_t cell, std::uint32_t object) const {
    return std::binary_search(rows_[cell].begin(), rows_[cell].end(), Entry{cell, object, {}, 0}, before);
  }
  std::span<const std::uint32_t> candidates(std::uint32_t cell) const {
    return not_hidden_ ? not_hidden_->row(cell) : all_;
  }

  /// work(item, found) gives the number of rays.
  template <typename Work>
  std::vector<Entry> stage(const std::string& name, std::uint64_t items, std::uint64_t items_a_piece,
                           const Work& work, const Progress& progress) {
    const auto pieces = runner_.run(
        name, (items + items_a_piece - 1) / items_a_piece,
        [&](std::uint64_t piece) {
          std::vector<Entry> found;
          std::uint64_t cast = 0;
          for (std::uint64_t i = piece * items_a_piece; i < std::min(items, (piece + 1) * items_a_piece);
               ++i) {
            cast += work(i, found);
          }
          JobRunner::Piece bytes;
          put(bytes, std::span<const Entry>(found));
          put(bytes, std::span<const std::uint64_t>(&cast, 1));
          return bytes;
        },
        progress);
    std::vector<Entry> all;
    for (std::span<const std::byte> bytes : pieces) {
      const std::vector<Entry> found = take<Entry>(bytes);
      all.insert(all.end(), found.begin(), found.end());
      for (const std::uint64_t cast : take<std::uint64_t>(bytes)) cast_ += cast;
    }
    return all;
  }

  /// `entries` are not in the rows yet, and stand in order within each.
  void add(const std::vector<Entry>& entries) {
    for (const Entry& entry : entries) rows_[entry.cell].push_back(entry);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (i > 0 && entries[i].cell == entries[i - 1].cell) continue;
      std::sort(rows_[entries[i].cell].begin(), rows_[entries[i].cell].end(), before);
    }
  }

  std::uint64_t look(std::uint32_t round, std::uint32_t cell, std::vector<Entry>& found) const {
    const CellPoints points(convex_of(cells_, cell));
    Look around(rays_, squares_);
    std::vector<Entry> own;
    if (round == 0) {
      for (const glm::vec3& point : sample_points(points)) around.from(point);
      for (const SeenObject& seen : around.seen()) {
        if (rays_.confirms(seen)) own.push_back({cell, seen.object, seen.line, around.degree(seen.object)});
      }
      std::sort(own.begin(), own.end(), before);
    }
    const auto knows = [](const std::vector<Entry>& row, std::uint32_t of, std::uint32_t object) {
      return std::binary_search(row.begin(), row.end(), Entry{of, object, {}, 0}, before);
    };
    std::vector<std::uint32_t> targets;
    for (const std::uint32_t object : candidates(cell)) {
      if (!knows(round == 0 ? own : rows_[cell], cell, object)) targets.push_back(object);
    }
    std::vector<SeenObject> hints;
    for (const std::uint32_t neighbour : neighbours_.row(cell)) {
      for (const Entry& entry : rows_[neighbour]) {
        if (!knows(rows_[cell], cell, entry.object)) hints.push_back({entry.object, entry.line});
      }
    }
    const AimedRays::Seen seen = rays_.from(points, targets, options_.rays,
                                            Random(options_.seed + round * 0x9e3779b97f4a7c15u, cell), hints);
    for (const auto& [object, line] : seen.objects)
      own.push_back({cell, object, line, around.degree(object)});
    std::sort(own.begin(), own.end(), before);
    found.insert(found.end(), own.begin(), own.end());
    return around.cast() + around.seen().size() + seen.rays;
  }

  std::uint64_t share(const Entry& entry, std::vector<Entry>& found) const {
    const glm::vec3 from = entry.line.from, to = entry.line.to;
    if (from == to) return 0;
    const Hit behind = rays_.caster().hit(from, from - to);
    const double back = std::min(double{behind.distance}, 1e9);
    const glm::dvec3 direction = glm::dvec3(from) - glm::dvec3(to);
    std::uint64_t cast = 1;
    tree_.along(to, direction, 1 + back, [&](std::uint32_t cell) {
      if (cell == entry.cell || sees(cell, entry.object)) return;
      if (not_hidden_ != nullptr && !not_hidden_->contains(cell, entry.object)) return;
      const CellPoints points(convex_of(cells_, cell));
      const auto part = points.part_of(to, direction, 1 + back);
      if (!part) return;
      const glm::vec3 start = points.within(glm::dvec3(to) + direction * (((*part)[0] + (*part)[1]) / 2));
      const SeenObject seen{entry.object, {start, to}};
      ++cast;
      if (rays_.confirms(seen)) found.push_back({cell, seen.object, seen.line, 0});
    });
    return cast;
  }

  const AimedRays& rays_;
  const ViewCells& cells_;
  const SampledOptions& options_;
  const VisibilityMatrix* not_hidden_;
  JobRunner& runner_;
  CellTree tree_;
  Squares squares_;
  VisibilityMatrix neighbours_;
  std::vector<std::vector<Entry>> rows_;
  std::vector<std::uint32_t> all_;
  std::uint64_t entries_ = 0, cast_ = 0;
};

void check(const SampledOptions& options) {
  if (options.resolution == 0 || options.resolution % 4 != 0 || options.resolution > 4096) {
    throw std::invalid_argument("sampling: the resolution must be a multiple of 4, 4 to 4096, not " +
                                std::to_string(options.resolution));
  }
  if (options.rounds == 0) throw std::invalid_argument("sampling: there must be a round at least");
  if (!(options.enough_yield >= 0)) throw std::invalid_argument("sampling: the yield must not be below 0");
}

glm::vec3 any_direction(Random& random) {
  const float z = random.between(-1, 1), turn = random.between(0, 6.2831853f), level = std::sqrt(1 - z * z);
  return {level * std::cos(turn), level * std::sin(turn), z};
}

}  // namespace

SeenFromCell see_from_cell(const AimedRays& rays, const CellPoints& cell,
                           std::span<const std::uint32_t> targets, const SampledOptions& options,
                           Random random) {
  check(options);
  const Squares squares(options.resolution);
  Look around(rays, squares);
  for (const glm::vec3& point : sample_points(cell)) around.from(point);
  SeenFromCell seen;
  for (const SeenObject& object : around.seen()) {
    if (rays.confirms(object)) seen.objects.push_back(object);
  }
  const auto by_object = [](const SeenObject& a, const SeenObject& b) { return a.object < b.object; };
  std::sort(seen.objects.begin(), seen.objects.end(), by_object);
  std::vector<std::uint32_t> rest;
  for (const std::uint32_t target : targets) {
    if (!std::binary_search(seen.objects.begin(), seen.objects.end(), SeenObject{target, {}}, by_object))
      rest.push_back(target);
  }
  const AimedRays::Seen more = rays.from(cell, rest, options.rays, random);
  seen.rays = around.cast() + around.seen().size() + more.rays;
  seen.objects.insert(seen.objects.end(), more.objects.begin(), more.objects.end());
  std::sort(seen.objects.begin(), seen.objects.end(), by_object);
  for (const SeenObject& object : seen.objects)
    seen.degree.push_back(std::max(around.degree(object.object), squares.least_degree()));
  return seen;
}

Sight see_by_sampling(const AimedRays& rays, const ViewCells& cells, const SampledOptions& options,
                      JobRunner& runner, const Progress& progress, const VisibilityMatrix* not_hidden) {
  check(options);
  const Shape shape{cells.count(), rays.scene().object_count};
  if (not_hidden != nullptr && not_hidden->shape() != shape) {
    throw std::invalid_argument("sampling: what is not hidden must be given for " +
                                std::to_string(shape.rows) + " view cells x " +
                                std::to_string(shape.columns) + " objects");
  }
  Rounds rounds(rays, cells, options, not_hidden, runner);
  ProgressOfRounds progress_of_rounds(progress, options.rounds);
  for (std::uint32_t round = 0; round < options.rounds; ++round) {
    const std::uint64_t added = rounds.run(round, progress_of_rounds.round(round));
    if (static_cast<double>(added) < options.enough_yield * static_cast<double>(rounds.entries())) break;
  }
  progress_of_rounds.end();
  return rounds.result();
}

Sight see_by_sampling(const Scene& scene, const ViewCells& cells, const SampledOptions& options,
                      JobRunner& runner, const Progress& progress, const VisibilityMatrix* not_hidden) {
  const RayCaster caster(scene);
  return see_by_sampling(AimedRays(scene, caster), cells, options, runner, progress, not_hidden);
}

std::vector<HeldBack> held_back_error(const AimedRays& rays, const ViewCells& cells,
                                      const VisibilityMatrix& seen, std::uint32_t rays_a_cell,
                                      std::uint64_t seed, JobRunner& runner, const Progress& progress) {
  const auto pieces = runner.run(
      "held-back rays", (cells.count() + cells_a_piece - 1) / cells_a_piece,
      [&](std::uint64_t piece) {
        std::vector<HeldBack> errors;
        std::vector<std::uint32_t> last_seen(rays.scene().object_count, 0xffffffff);
        for (std::uint64_t c = piece * cells_a_piece;
             c < std::min<std::uint64_t>(cells.count(), (piece + 1) * cells_a_piece); ++c) {
          const auto cell = static_cast<std::uint32_t>(c);
          const CellPoints points(convex_of(cells, cell));
          Random random(~seed, cell);
          HeldBack error;
          for (const bool aimed : {false, true}) {
            if (rays.scene().object_count == 0) break;
            for (std::uint32_t first = 0; first < rays_a_cell; first += RayCaster::width) {
              const std::uint32_t count = std::min(RayCaster::width, rays_a_cell - first);
              Packet origins{}, directions{};
              for (std::uint32_t i = 0; i < count; ++i) {
                origins[i] = points.on_face(random);
                const std::uint32_t object = random.below(std::max(rays.scene().object_count, 1u));
                directions[i] = aimed && rays.has_area(object) ? rays.point_of(object, random) - origins[i]
                                                               : any_direction(random);
              }
              see_along(rays.scene(), rays.caster(), origins, directions, count, false,
                        [&](unsigned, std::uint32_t triangle, float) {
                          const std::uint32_t object = rays.scene().object_of_triangle[triangle];
                          const bool missed = !seen.contains(cell, object);
                          if (!aimed) ++error.rays, error.missed_rays += missed;
                          if (std::exchange(last_seen[object], cell) == cell) return;
                          ++error.objects, error.missed_objects += missed;
                        });
            }
          }
          errors.push_back(error);
        }
        JobRunner::Piece bytes;
        put(bytes, std::span<const HeldBack>(errors));
        return bytes;
      },
      progress);
  std::vector<HeldBack> all;
  for (std::span<const std::byte> bytes : pieces) {
    const std::vector<HeldBack> errors = take<HeldBack>(bytes);
    all.insert(all.end(), errors.begin(), errors.end());
  }
  return all;
}

double missed_at_most(std::uint64_t missed, std::uint64_t of, double confidence) {
  if (missed >= of) return 1;
  // The probability at which so few would still come true in 1 - confidence of all cases.
  double low = static_cast<double>(missed) / static_cast<double>(of), high = 1;
  for (int step = 0; step < 60; ++step) {
    const double p = (low + high) / 2;
    double at_most = 0, log_choose = 0;
    for (std::uint64_t k = 0; k <= missed; ++k) {
      if (k > 0) log_choose += std::log(static_cast<double>(of - k + 1) / static_cast<double>(k));
      at_most += std::exp(log_choose + static_cast<double>(k) * std::log(p) +
                          static_cast<double>(of - k) * std::log1p(-p));
    }
    (at_most > 1 - confidence ? low : high) = p;
  }
  return high;
}

VisibilityMatrix dense_reference(const AimedRays& rays, const ViewCells& cells,
                                 std::span<const std::uint32_t> ids, JobRunner& runner,
                                 const Progress& progress) {
  const Squares squares(96);
  const auto pieces = runner.run(
      "reference", ids.size(),
      [&](std::uint64_t i) {
        const CellPoints points(convex_of(cells, ids[i]));
        Random random(0x5eed, ids[i]);
        Look around(rays, squares);
        for (std::size_t k = 0; k < points.cell().vertices.size(); ++k) around.from(points.vertex(k));
        for (unsigned k = 0; k < 40; ++k) around.from(points.on_face(random));
        std::vector<bool> seen(rays.scene().object_count, false);
        for (const SeenObject& object : around.seen()) seen[object.object] = true;
        for (std::uint32_t object = 0; object < seen.size(); ++object) {
          for (unsigned first = 0; first < 1500 && !seen[object] && rays.has_area(object);
               first += RayCaster::width) {
            Packet origins{}, directions{};
            for (unsigned k = 0; k < RayCaster::width; ++k) {
              origins[k] = points.on_face(random), directions[k] = rays.point_of(object, random) - origins[k];
            }
            see_along(rays.scene(), rays.caster(), origins, directions, RayCaster::width, false,
                      [&](unsigned, std::uint32_t triangle, float) {
                        seen[rays.scene().object_of_triangle[triangle]] = true;
                      });
          }
        }
        std::vector<std::uint32_t> row;
        for (std::uint32_t object = 0; object < seen.size(); ++object) {
          if (seen[object]) row.push_back(object);
        }
        JobRunner::Piece bytes;
        put(bytes, std::span<const std::uint32_t>(row));
        return bytes;
      },
      progress);
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::span<const std::byte> bytes : pieces) rows.push_back(take<std::uint32_t>(bytes));
  return VisibilityMatrix::from_rows(rows, rays.scene().object_count);
}

std::string describe(const SampledOptions& o) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "rays: cube maps of 6 x %u^2, %llu aimed a cell and round, at most %u rounds, enough %g, seed %llu",
      o.resolution, static_cast<unsigned long long>(o.rays), o.rounds, static_cast<double>(o.enough_yield),
      static_cast<unsigned long long>(o.seed));
  return text;
}

}  // namespace vismat
