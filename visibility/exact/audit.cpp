#include "visibility/exact/audit.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "visibility/exact/witness.h"
#include "visibility/rays/aimed_rays.h"

namespace vismat {
namespace {

struct Entry {
  std::uint32_t row, column;
  std::uint64_t number;  // among the ones
};

// Uniform among the ones, or among the zeros.
class Entries {
 public:
  explicit Entries(const VisibilityMatrix& matrix) : matrix_(matrix) {
    for (std::uint32_t row = 0; row < matrix.shape().rows; ++row) {
      first_one_.push_back(first_one_.back() + matrix.row(row).size());
      first_zero_.push_back(first_zero_.back() + matrix.shape().columns - matrix.row(row).size());
    }
  }
  Entry one(Random& random) const {
    const std::uint64_t number = random.next() % matrix_.ones();
    const std::uint32_t row = row_of(number, first_one_);
    return {row, matrix_.row(row)[number - first_one_[row]], number};
  }
  Entry zero(Random& random) const {
    std::uint64_t left = random.next() % first_zero_.back();
    const std::uint32_t row = row_of(left, first_zero_);
    left -= first_zero_[row];
    std::uint32_t column = static_cast<std::uint32_t>(left);
    for (const std::uint32_t one : matrix_.row(row)) column += one <= column;
    return {row, column, 0};
  }

 private:
  static std::uint32_t row_of(std::uint64_t number, const std::vector<std::uint64_t>& first) {
    return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), number) - first.begin() -
                                      1);
  }
  const VisibilityMatrix& matrix_;
  std::vector<std::uint64_t> first_one_ = {0}, first_zero_ = {0};  // of each row, and the end
};

void note(Audit::Side& side, const Entry& entry, const Doubt& doubt) {
  ++side.checked;
  if (!doubt) {
    ++side.confirmed;
  } else if (!side.first_not_confirmed) {
    side.first_not_confirmed =
        "row " + std::to_string(entry.row) + ", column " + std::to_string(entry.column) + ": " + *doubt;
  }
}

}  // namespace

Audit audit(const Dataset& dataset, const Scene& scene, const ViewCells& cells, const AuditOptions& options,
            const Progress& progress) {
  const Shape shape = dataset.matrix.shape();
  if (dataset.source.columns_are_nodes)
    throw std::invalid_argument("its columns are nodes; only objects can be checked");
  if (!dataset.source.column_levels.empty())
    throw std::invalid_argument("its columns are levels of detail; only whole objects can be checked");
  if (shape != Shape{cells.count(), scene.object_count}) {
    throw std::invalid_argument("has " + std::to_string(shape.rows) + " x " + std::to_string(shape.columns) +
                                " entries, but the scene " + std::to_string(cells.count()) +
                                " view cells and " + std::to_string(scene.object_count) +
                                " objects; 'vismat cells' puts view cells into a scene file");
  }
  if (dataset.guarantee == Guarantee::unknown) {
    throw std::invalid_argument(
        "claims neither that what it lists is seen nor that the rest is hidden (guarantee: unknown)");
  }
  const WitnessCheck check(scene);
  const Entries entries(dataset.matrix);
  Audit audit;
  audit.seen.entries = dataset.guarantee == Guarantee::conservative ? 0 : dataset.matrix.ones();
  audit.hidden.entries = dataset.guarantee == Guarantee::aggressive
                             ? 0
                             : std::uint64_t{shape.rows} * shape.columns - dataset.matrix.ones();
  const std::uint64_t seen = audit.seen.entries > 0 ? options.entries : 0,
                      hidden = audit.hidden.entries > 0 ? options.entries : 0;

  if (seen > 0) {
    std::optional<RayCaster> caster;
    std::optional<AimedRays> rays;
    if (dataset.sight_lines.empty()) rays.emplace(scene, caster.emplace(scene));
    Random random(options.seed, 0);
    for (std::uint64_t i = 0; i < seen; ++i) {
      if (progress) progress(i, seen + hidden);
      const Entry entry = entries.one(random);
      const Convex cell = convex_of(cells, entry.row);
      std::optional<SightLine> line;
      if (rays) {
        const auto found = rays->from(CellPoints(cell), std::span(&entry.column, 1), options.rays,
                                      Random(options.seed, i + 1));
        if (!found.objects.empty()) line = found.objects[0].line;
      } else {
        const std::array<float, 6>& ends = dataset.sight_lines[entry.number];
        line = {{ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}};
      }
      note(audit.seen, entry,
           line ? check.seen(cell, entry.column, *line, &audit.seen.aimed_again)
                : "none of " + std::to_string(options.rays) + " rays reaches it");
    }
  }

  if (hidden > 0) {
    const Shadows shadows(scene, occluders_for(scene, cells, {}));
    ShadowOptions casting;
    casting.points = 9;
    casting.patches = options.patches;
    casting.patch_resolution = 512;
    const auto view = shadows.view(casting);
    Random random(options.seed, 0x68696464656e);
    for (std::uint64_t i = 0; i < hidden; ++i) {
      if (progress) progress(seen + i, seen + hidden);
      const Entry entry = entries.zero(random);
      const Convex cell = convex_of(cells, entry.row);
      note(audit.hidden, entry,
           check.hidden(cell, entry.column, view->witness(cell, entry.column), shadows.occluders(),
                        options.points, Random(options.seed, ~i)));
    }
  }
  if (progress && seen + hidden > 0) progress(seen + hidden, seen + hidden);
  return audit;
}

}  // namespace vismat
