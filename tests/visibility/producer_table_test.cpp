// Every producer of the table: its guarantee holds, its options are known, and it gives the same for any number of threads and
// after any end of earlier runs.
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <set>

#include "tests/sanitized.h"
#include "tests/visibility/analytic_scenes.h"
#include "visibility/generators/city.h"
#include "visibility/producers/producers.h"

namespace vismat {
namespace {

/// Keeps pieces in memory, and fails once it holds `most`, as a run does that is ended.
class MemoryStore : public PieceStore {
 public:
  std::size_t most = ~std::size_t{0};

  std::size_t size() const { return pieces_.size(); }
  std::vector<std::uint64_t> restore(const std::string& stage,
                                     std::vector<JobRunner::Piece>& pieces) override {
    std::vector<std::uint64_t> missing;
    for (std::uint64_t i = 0; i < pieces.size(); ++i) {
      const auto at = pieces_.find({stage, i});
      if (at == pieces_.end()) {
        missing.push_back(i);
      } else {
        pieces[i] = at->second;
      }
    }
    return missing;
  }
  void store(const std::string& stage, std::uint64_t number, const JobRunner::Piece& piece) override {
    const std::lock_guard lock(mutex_);
    if (pieces_.size() >= most) throw std::runtime_error("the end");
    pieces_[{stage, number}] = piece;
  }

 private:
  std::map<std::pair<std::string, std::uint64_t>, JobRunner::Piece> pieces_;
  std::mutex mutex_;
};

/// A few view cells of a small city, all of which every producer can serve: triangles of the ground.
SceneFile small_city() {
  CityOptions options;
  options.size = 4;
  options.eye_low = 1.5f, options.eye_high = 2;
  SceneFile city = make_city(options);
  city.cells.corners.resize(3 * std::size_t{test::sanitized ? 12 : 20});
  city.cells.neighbours.reset();
  return city;
}

/// The base of a box as two triangles, for eyes between its bottom and its top.
ViewCells on_the_ground(const Box& box) {
  ViewCells cells;
  const auto corner = [&](bool right, bool back) {
    return glm::vec3((right ? box.high : box.low)[0], (back ? box.high : box.low)[1], 0);
  };
  cells.corners = {corner(false, false), corner(true, false), corner(true, true),
                   corner(false, false), corner(true, true),  corner(false, true)};
  cells.eye_low = box.low[2], cells.eye_high = box.high[2];
  return cells;
}

TEST(Producers, TellTruthOfScenesThatAreKnown) {
  int scenes = 0;
  for (const AnalyticScene& s : plain_analytic_scenes()) {
    if (s.cell.low[0] == s.cell.high[0] || s.cell.low[1] == s.cell.high[1]) continue;
    if (++scenes % 5 != 0 && test::sanitized) continue;
    const ViewCells cells = on_the_ground(s.cell);
    for (const Producer& producer : producers()) {
      SCOPED_TRACE(s.name + ", " + std::string(producer.name));
      ThreadJobRunner runner;
      const Sight sight = producer.see(s.scene, cells, {}, runner, {});
      const auto either = [&](const VisibilityMatrix& matrix, std::uint32_t object) {
        return matrix.contains(0, object) || matrix.contains(1, object);
      };
      for (std::uint32_t object = 0; object < s.scene.object_count; ++object) {
        const bool seen = s.truth[object] == Truth::seen;
        if (producer.guarantee != Guarantee::aggressive && seen) {
          EXPECT_TRUE(either(producer.listed(sight), object)) << "object " << object;
        }
        if (producer.guarantee != Guarantee::conservative && !seen) {
          EXPECT_FALSE(either(producer.listed(sight), object)) << "object " << object;
        }
        if (producer.seen_too && !seen) {
          EXPECT_FALSE(either(sight.seen, object)) << "object " << object;
        }
      }
    }
  }
  EXPECT_GE(scenes, 8);
}

TEST(Producers, GiveTheSameForAnyNumberOfThreadsAndAfterAnyEnd) {
  const SceneFile city = small_city();
  ProducerOptions options;
  if (test::sanitized) options.effort = 0;
  for (const Producer& producer : producers()) {
    SCOPED_TRACE(std::string(producer.name));
    const auto run = [&](unsigned threads, MemoryStore& store) {
      ThreadJobRunner runner(threads);
      runner.keep_in(store);
      return producer.see(city.scene, city.cells, options, runner, {});
    };
    MemoryStore all;
    const Sight expected = run(1, all);
    ASSERT_GE(all.size(), 2u) << "its work must go through the runner, in pieces";
    EXPECT_EQ(producer.listed(expected).shape(), (Shape{city.cells.count(), city.scene.object_count}));
    for (const std::size_t entries : {expected.lines.size(), expected.degree.size()}) {
      EXPECT_TRUE(entries == 0 || entries == expected.seen.ones()) << entries;
    }
    MemoryStore fresh;
    EXPECT_EQ(run(3, fresh), expected);
    EXPECT_EQ(fresh.size(), all.size());
    MemoryStore ended;
    for (const std::size_t more : {all.size() / 3, all.size() / 3, all.size()}) {
      ended.most = ended.size() + more;
      if (ended.most >= all.size()) {
        EXPECT_EQ(run(2, ended), expected);
      } else {
        EXPECT_THROW(run(2, ended), std::runtime_error);
      }
    }
    EXPECT_EQ(ended.size(), all.size());
    all.most = all.size();
    EXPECT_EQ(run(1, all), expected) << "with nothing left to do";
  }
}

TEST(Producers, AreFineWithNothingToSeeAndNobodyToSeeIt) {
  ViewCells cell = small_city().cells;
  cell.corners.resize(3);
  for (const Producer& producer : producers()) {
    SCOPED_TRACE(std::string(producer.name));
    ThreadJobRunner runner;
    EXPECT_EQ(producer.listed(producer.see({}, cell, {}, runner, {})).shape(), (Shape{1, 0}));
    const Sight nobody = producer.see(small_city().scene, {}, {}, runner, {});
    EXPECT_EQ(producer.listed(nobody).shape(), (Shape{0, 16}));
  }
}

/// The option at another value than any default.
ProducerOptions with(const ProducerSetting& setting) {
  ProducerOptions options;
  std::visit([&](auto member) { options.*member = 2; }, setting);
  return options;
}

TEST(Producers, NameWhateverTheyDependOn) {
  std::set<std::string_view> names, option_names;
  for (const ProducerOption& option : producer_options()) {
    EXPECT_TRUE(option_names.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.help.empty()) << option.name;
    EXPECT_FALSE(takers_of(option).empty()) << option.name;
  }
  for (const Producer& producer : producers()) {
    SCOPED_TRACE(std::string(producer.name));
    EXPECT_TRUE(names.insert(producer.name).second);
    EXPECT_EQ(&producer_named(producer.name), &producer);
    EXPECT_FALSE(producer.idea.empty());
    EXPECT_NE(producer.guarantee, Guarantee::unknown);
    const std::string made = producer.describe({});
    std::size_t known = 0;
    for (const ProducerOption& option : producer_options()) {
      SCOPED_TRACE(std::string(option.name));
      if (!producer.takes(option.setting)) {
        EXPECT_THROW(check_taken(producer, with(option.setting)), std::invalid_argument);
        continue;
      }
      ++known;
      check_taken(producer, with(option.setting));
      EXPECT_NE(producer.describe(with(option.setting)), made);
      if (option.by_default.empty()) continue;
      ProducerOptions same;
      std::visit(
          [&](auto member) {
            const double value = std::stod(std::string(option.by_default));
            (same.*member)
                .emplace(static_cast<typename std::decay_t<decltype(same.*member)>::value_type>(value));
          },
          option.setting);
      EXPECT_EQ(producer.describe(same), made) << "help tells a wrong default";
    }
    EXPECT_EQ(known, producer.options.size()) << "an option without a name";
  }
  EXPECT_THROW(producer_named("none such"), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
