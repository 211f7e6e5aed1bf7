#include "matrix/files/hdf5_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "tests/matrix/temporary_folder.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

template <typename Number>
std::span<const Number> view(const std::vector<Number>& values) {
  return values;
}

TEST(Hdf5File, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  std::vector<std::uint32_t> ids(1'000'000);  // several chunks
  Random random(1);
  for (auto& id : ids) id = random.below(0xffffffff);
  const std::vector<float> boxes = {0, 1, 2, 3, 4, 5, -1, -2, -3, -4, -5, 1e30f};
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.write("/ids", view(ids), {ids.size()});
    file.write("/deep/er/boxes", view(boxes), {2, 6});
    file.write("/none", view(std::vector<std::uint64_t>{}), {0});
    file.write("/bytes", view(std::vector<std::uint8_t>{0, 7}), {2});
    file.write_attribute("/", "text", std::string("zwölf\nlines"));
    file.write_attribute("/deep/er", "number", ~std::uint64_t{0});
    file.close();
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_EQ(file.read<std::uint32_t>("/ids"), ids);
  EXPECT_EQ(file.read<std::uint64_t>("/ids"), std::vector<std::uint64_t>(ids.begin(), ids.end()));
  EXPECT_EQ(file.read<float>("/deep/er/boxes"), boxes);
  EXPECT_EQ(file.dimensions("/deep/er/boxes"), (std::vector<std::uint64_t>{2, 6}));
  EXPECT_TRUE(file.read<std::uint64_t>("/none").empty());
  EXPECT_EQ(file.read_truth("/bytes"), (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(file.read_truth("/deep/er/boxes")[0], 0);
  EXPECT_TRUE(file.contains("/deep/er"));
  EXPECT_FALSE(file.contains("/deep/less/boxes"));
  EXPECT_EQ(file.string_attribute("/", "text"), "zwölf\nlines");
  EXPECT_EQ(file.string_attribute("/", "other"), std::nullopt);
  EXPECT_EQ(file.number_attribute("/deep/er", "number"), ~std::uint64_t{0});
}

TEST(Hdf5File, RefusalsNameThePlace) {
  const TemporaryFolder folder;
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.write("/large", view(std::vector<std::uint64_t>{1, 1ull << 40}), {2});
    file.write("/floats", view(std::vector<float>{1}), {1});
    file.write_attribute("/", "text", std::string("x"));
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_EQ(test::refusal<FormatError>([&] { file.read<std::uint32_t>("/large"); }),
            "/large: entry 1 is 1099511627776; it must lie between 0 and 4294967295");
  EXPECT_NE(test::refusal<FormatError>([&] {
              file.read<std::uint32_t>("/floats");
            }).find("/floats: holds floating"),
            std::string::npos);
  EXPECT_EQ(test::refusal<FormatError>([&] { file.read<float>("/nothing"); }), "/nothing: is missing");
  EXPECT_EQ(test::refusal<FormatError>([&] { file.read<float>("/"); }), "/: is not an array");
  EXPECT_NE(test::refusal<FormatError>([&] { file.number_attribute("/", "text"); }).find("attribute text"),
            std::string::npos);
  EXPECT_NE(test::refusal<FormatError>([&] { file.string_attribute("/nothing", "text"); }), "");
  EXPECT_EQ(file.read<float>("/floats"), std::vector<float>{1});  // still answering
}

TEST(Hdf5File, SameCallsSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"a.h5", "b.h5"}) {
    Hdf5File file = Hdf5File::create(folder / name);
    std::vector<std::uint32_t> ids(300'000);
    std::iota(ids.begin(), ids.end(), 0);
    file.write("/group/ids", view(ids), {ids.size()});
    file.write_attribute("/group", "text", std::string("x"));
    file.close();
  }
  EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
}

TEST(Hdf5File, SeveralMayBeOpen) {
  const TemporaryFolder folder;
  for (const char* name : {"a.h5", "b.h5"}) {
    Hdf5File::create(folder / name).write_attribute("/", "name", std::string(name));
  }
  auto first = std::make_unique<Hdf5File>(Hdf5File::open(folder / "a.h5"));
  const Hdf5File second = Hdf5File::open(folder / "b.h5");
  EXPECT_EQ(first->string_attribute("/", "name"), "a.h5");
  first.reset();
  EXPECT_EQ(second.string_attribute("/", "name"), "b.h5");
}

TEST(Hdf5File, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_NE(test::refusal<FormatError>([&] { Hdf5File::open(folder / "missing"); }).find("No such file"),
            std::string::npos);
  EXPECT_NE(test::refusal<FormatError>([&] { Hdf5File::open(folder / ""); }).find("regular"),
            std::string::npos);
  std::ofstream(folder / "text") << "hello";
  EXPECT_NE(test::refusal<FormatError>([&] { Hdf5File::open(folder / "text"); }).find("no HDF5 file"),
            std::string::npos);
  EXPECT_NE(test::refusal<FormatError>([&] { Hdf5File::create(folder / "missing/x"); }), "");
  EXPECT_FALSE(is_hdf5(folder / "text"));
  EXPECT_FALSE(is_hdf5(folder / "missing"));
}

}  // namespace
}  // namespace vismat
