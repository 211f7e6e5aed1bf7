// The disk's clock against times worked out by hand, and against channels that are kept as a sorted list.
#include "runtime/storage/virtual_disk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "matrix/base/random.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

using test::refusal;

TEST(VirtualDisk, PresetsAreWhatTheirSourcesSay) {
  std::set<std::string_view> names;
  for (const DiskModel& model : disk_models()) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name;
    EXPECT_GT(model.source.size(), 50u) << model.name;
    EXPECT_EQ(&disk_model(model.name), &model);
    EXPECT_NO_THROW(VirtualDisk(model, 1));
  }
  // One page from an idle disk takes as long as the data sheets' rates of small reads say, to 1 %.
  EXPECT_NEAR(static_cast<double>(VirtualDisk(disk_model("sata-ssd"), 1).begin(0, 4096)), 1e9 / 10'000, 1e3);
  EXPECT_NEAR(static_cast<double>(VirtualDisk(disk_model("nvme"), 1).begin(0, 4096)), 1e9 / 15'000, 1e3);
  EXPECT_EQ(disk_model("sata-ssd").channels * disk_model("sata-ssd").bytes_per_second, 540e6);
  EXPECT_EQ(disk_model("nvme").channels * disk_model("nvme").bytes_per_second, 3400e6);
  EXPECT_EQ(disk_model("network").channels * disk_model("network").bytes_per_second, 100e6 / 8);
  EXPECT_EQ(VirtualDisk(disk_model("disk-2004"), 1).begin(0, 4'000'000), 109'000'000);
}

TEST(VirtualDisk, NamesAndNumbers) {
  EXPECT_EQ(refusal<std::invalid_argument>([] { disk_model("tape"); }),
            "no disk is called 'tape'; there are disk-2004, sata-ssd, nvme, network");
  EXPECT_EQ(parse_disk_model("nvme").latency, disk_model("nvme").latency);
  const DiskModel custom = parse_disk_model("13.5,40,1,4.2");
  EXPECT_EQ(custom.name, "custom");
  EXPECT_EQ(custom.latency, 13'500'000);
  EXPECT_EQ(custom.jitter, 4'200'000);
  EXPECT_EQ(custom.bytes_per_second, 40e6);
  EXPECT_EQ(custom.channels, 1u);
  EXPECT_EQ(parse_disk_model("0,0.000001,256").jitter, 0);
  for (const char* const wrong :
       {"",        "tape",    ",",       "1,2",     "1,2,3,4,5", "1,2,0",     "1,2,1.5",
        "1,2,257", "1,0,1",   "-1,2,1",  "1,2,1,2", "1,2,1,-1",  "60001,1,1", "1,1000001,1",
        "1,x,1",   "nan,1,1", "1,nan,1", "1,2,nan", "1,2,1,nan", "1,2,1 ",    "1, 2,1"}) {
    EXPECT_NE(refusal<std::invalid_argument>([&] { parse_disk_model(wrong); }), "") << wrong;
  }
}

TEST(VirtualDisk, AReadTakesTheChannelThatIsFreeFirst) {
  const DiskModel model{"two", 10, 0, 1e9, 2, ""};  // 1 byte a nanosecond
  VirtualDisk disk(model, 1);
  EXPECT_EQ(disk.free_at(), 0);
  EXPECT_EQ(disk.begin(100, 5), 115);
  EXPECT_EQ(disk.free_at(), 0);  // the other one
  EXPECT_EQ(disk.begin(100, 50), 160);
  EXPECT_EQ(disk.free_at(), 115);
  EXPECT_EQ(disk.begin(100, 0), 125);  // after the first
  EXPECT_EQ(disk.begin(100, 0), 135);
  EXPECT_EQ(disk.begin(1000, 1), 1011);
  EXPECT_EQ(disk.reads(), 5u);
}

TEST(VirtualDisk, TimesEqualASortedListOfChannels) {
  Random random(3);
  for (const unsigned channels : {1u, 3u, 8u}) {
    const DiskModel model{"some", 1000, 400, 2e9, channels, ""};
    VirtualDisk disk(model, 7);
    std::multiset<Nanoseconds> free;
    for (unsigned c = 0; c < channels; ++c) free.insert(0);
    Nanoseconds now = 0;
    for (std::uint64_t n = 0; n < 2000; ++n) {
      now += random.below(1500);
      const std::uint64_t bytes = random.below(4) * 1000;
      const Nanoseconds jitter = std::llround(400 * (2 * Random(7, n).fraction() - 1));
      const Nanoseconds end =
          std::max(now, *free.begin()) + 1000 + jitter + static_cast<Nanoseconds>(bytes / 2);
      free.erase(free.begin());
      free.insert(end);
      ASSERT_EQ(disk.begin(now, bytes), end);
      ASSERT_EQ(disk.free_at(), *free.begin());
    }
  }
}

TEST(VirtualDisk, JitterDependsOnTheSeedAndTheNumberAlone) {
  const DiskModel& model = disk_model("network");
  VirtualDisk a(model, 5), b(model, 5), other(model, 6);
  std::set<Nanoseconds> latencies;
  bool differs = false;
  for (int n = 0; n < 1000; ++n) {
    const Nanoseconds begin = n * Nanoseconds{1'000'000'000};
    const Nanoseconds latency = a.begin(begin, 0) - begin;
    EXPECT_EQ(b.begin(begin + 17, 3'125'000) - begin - 17, latency + 1'000'000'000);
    differs |= other.begin(begin, 0) - begin != latency;
    EXPECT_GE(latency, 10'000'000);
    EXPECT_LE(latency, 30'000'000);
    latencies.insert(latency);
  }
  EXPECT_TRUE(differs);
  EXPECT_LT(*latencies.begin(), 10'500'000);
  EXPECT_GT(*latencies.rbegin(), 29'500'000);
}

TEST(VirtualDisk, RefusesAModelThatIsNone) {
  const DiskModel good{"good", 10, 10, 1, 1, ""};
  EXPECT_NO_THROW(VirtualDisk(good, 1));
  DiskModel bad = good;
  bad.channels = 0;
  EXPECT_THROW(VirtualDisk(bad, 1), std::invalid_argument);
  bad = good;
  bad.jitter = 11;
  EXPECT_THROW(VirtualDisk(bad, 1), std::invalid_argument);
  bad = good;
  bad.bytes_per_second = .5;
  EXPECT_THROW(VirtualDisk(bad, 1), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
