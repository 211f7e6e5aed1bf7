#include "visibility/exact/audit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sanitized.h"
#include "visibility/exact/witness.h"
#include "visibility/generators/city.h"
#include "visibility/rays/sampled.h"

namespace vismat {
namespace {

struct Town {
  SceneFile file;
  Sight sight;
};
const Town& town() {
  static const Town town = [] {
    CityOptions options;
    options.size = 8;
    Town made{make_city(options), {}};
    // A few cells are enough.
    ViewCells& cells = made.file.cells;
    cells.corners.resize(std::min<std::size_t>(cells.corners.size(), 3 * 40));
    cells.neighbours.reset();
    ThreadJobRunner runner(1);
    SampledOptions sampled;
    sampled.rounds = 1;
    made.sight = see_by_sampling(made.file.scene, cells, sampled, runner);
    const Shadows shadows(made.file.scene, find_occluders(made.file.scene));
    const auto view = shadows.view({});
    std::vector<std::vector<std::uint32_t>> rows;
    for (std::uint32_t cell = 0; cell < cells.count(); ++cell)
      rows.push_back(view->not_hidden(convex_of(cells, cell)));
    made.sight.not_hidden = VisibilityMatrix::from_rows(rows, made.file.scene.object_count);
    return made;
  }();
  return town;
}

Dataset seen_of(const Town& t) {
  Dataset dataset;
  dataset.matrix = t.sight.seen;
  dataset.guarantee = Guarantee::aggressive;
  for (const SightLine& line : t.sight.lines) {
    dataset.sight_lines.push_back({line.from.x, line.from.y, line.from.z, line.to.x, line.to.y, line.to.z});
  }
  return dataset;
}

Audit audited(const Dataset& dataset, const AuditOptions& options = {}) {
  return audit(dataset, town().file.scene, town().file.cells, options);
}

TEST(Audit, SightLines) {
  Dataset dataset = seen_of(town());
  ASSERT_EQ(dataset.sight_lines.size(), dataset.matrix.ones());
  Audit found = audited(dataset);
  EXPECT_EQ(found.seen.checked, 200u);
  EXPECT_EQ(found.seen.confirmed, 200u) << found.seen.first_not_confirmed.value_or("");
  EXPECT_EQ(found.hidden.checked, 0u);

  std::rotate(dataset.sight_lines.begin(), dataset.sight_lines.begin() + 1, dataset.sight_lines.end());
  found = audited(dataset);
  EXPECT_LT(found.seen.confirmed, 20u);  // some end where two objects meet
  EXPECT_TRUE(found.seen.first_not_confirmed);

  dataset.sight_lines.clear();  // then rays look for new ones
  found = audited(dataset);
  EXPECT_GE(found.seen.confirmed, 195u) << found.seen.first_not_confirmed.value_or("");
}

TEST(Audit, Occluders) {
  Dataset dataset;
  dataset.matrix = town().sight.not_hidden;
  dataset.guarantee = Guarantee::conservative;
  AuditOptions some;
  some.entries = test::trials(200u);
  Audit found = audited(dataset, some);
  EXPECT_EQ(found.seen.checked, 0u);
  EXPECT_EQ(found.hidden.checked, some.entries);
  EXPECT_EQ(found.hidden.confirmed, some.entries) << found.hidden.first_not_confirmed.value_or("");

  // What claims that nothing is seen at all is caught at what rays saw.
  dataset.matrix = VisibilityMatrix::from_rows(
      std::vector<std::vector<std::uint32_t>>(dataset.matrix.shape().rows), dataset.matrix.shape().columns);
  AuditOptions options;
  options.entries = test::trials(40u), options.patches = 10;
  found = audited(dataset, options);
  EXPECT_LT(found.hidden.confirmed, options.entries);
  EXPECT_TRUE(found.hidden.first_not_confirmed);
}

TEST(Audit, RefusesWhatItCannotCheck) {
  Dataset dataset;
  dataset.matrix = town().sight.seen;
  EXPECT_THROW(audited(dataset), std::invalid_argument);
  dataset.guarantee = Guarantee::aggressive;
  dataset.matrix = VisibilityMatrix::from_rows({{0}}, 1);
  EXPECT_THROW(audited(dataset), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
