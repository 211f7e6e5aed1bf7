#include "programs/output_check.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <vector>

#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

class OutputCheck : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder / "in.mtx") << "in"; }
  /// Empty if the outputs are accepted.
  std::string refusal(const std::vector<OutputName>& outputs,
                      std::vector<std::filesystem::path> inputs = {}) {
    try {
      check_outputs(inputs, outputs);
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  }
  void expect_refusal(const std::string& why, const std::vector<OutputName>& outputs,
                      std::vector<std::filesystem::path> inputs = {}) {
    const std::string told = refusal(outputs, std::move(inputs));
    EXPECT_NE(told.find(why), std::string::npos) << told;
  }
  TemporaryFolder folder;
};

TEST_F(OutputCheck, KnowsTheEndings) {
  const auto name = [&](const char* file, Written what) { return OutputName{"-o", folder / file, what}; };
  for (const char* file : {"a.bsp.h5", "a.h5", "a.hdf5", "a.mtx"})
    EXPECT_EQ(refusal({name(file, Written::matrix)}), "");
  for (const char* file : {"a", "a.txt", "a.h5.gz", "a.scene", "mtx"})
    expect_refusal("a matrix is written as", {name(file, Written::matrix)});
  for (const char* file : {"a.scene.h5", "a.h5"}) EXPECT_EQ(refusal({name(file, Written::scene)}), "");
  for (const char* file : {"a.obj", "a", "a.mtx"})
    expect_refusal("a scene is written as", {name(file, Written::scene)});
  EXPECT_EQ(refusal({name("a.vmat", Written::vmat)}), "");
  expect_refusal("is written as .vmat", {name("a.bsp.h5", Written::vmat)});
  for (const char* file : {"a.csv", "a", "a.json", "a.txt"})
    EXPECT_EQ(refusal({name(file, Written::text)}), "");
  for (const char* file : {"a.mtx", "a.h5", "a.vmat"})
    expect_refusal("the name of a matrix or scene", {name(file, Written::text)});
}

TEST_F(OutputCheck, KnowsAnInputByAnyName) {
  const auto in = folder / "in.mtx";
  std::filesystem::create_hard_link(in, folder / "hard.mtx");
  std::filesystem::create_symlink("in.mtx", folder / "soft.mtx");
  std::filesystem::create_symlink(".", folder / "here");
  for (const char* other : {"in.mtx", "hard.mtx", "soft.mtx", "here/in.mtx", "here/./here/soft.mtx"}) {
    expect_refusal("is the input", {{"-o", folder / other, Written::matrix}}, {in});
    expect_refusal("is the input", {{"-o", folder / other, Written::matrix}}, {in.string() + ":maps/a.bsp"});
  }
  EXPECT_EQ(refusal({{"-o", folder / "other.mtx", Written::matrix}}, {in, folder / "missing.mtx"}), "");
}

TEST_F(OutputCheck, KeepsOutputsApart) {
  std::filesystem::create_symlink("later.mtx", folder / "soft.mtx");
  std::filesystem::create_symlink(".", folder / "here");
  for (const char* other : {"later.mtx", "soft.mtx", "here/later.mtx"}) {
    expect_refusal("-o writes the same file", {{"-o", folder / "later.mtx", Written::matrix},
                                               {"--seen", folder / other, Written::matrix}});
  }
  EXPECT_EQ(
      refusal({{"--csv", "/dev/null", Written::text}, {"--json", "/dev/null", Written::text}}, {"/dev/null"}),
      "");
}

TEST_F(OutputCheck, LooksWhetherTheyCanBeWritten) {
  expect_refusal("No such file", {{"-o", folder / "no/a.mtx", Written::matrix}});
  expect_refusal("Not a directory", {{"-o", folder / "in.mtx/a.mtx", Written::matrix}});
  expect_refusal("No such file", {{"--out", folder / "no", Written::folder}});
  expect_refusal("Not a directory", {{"--out", folder / "in.mtx", Written::folder}});
  EXPECT_EQ(refusal({{"--out", folder / "", Written::folder}}), "");
  std::filesystem::create_directory(folder / "a.mtx");
  expect_refusal("Is a directory", {{"-o", folder / "a.mtx", Written::matrix}});
  ASSERT_EQ(::mkfifo((folder / "pipe.mtx").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder / "pipe.h5").c_str(), 0600), 0);
  EXPECT_EQ(refusal({{"-o", folder / "pipe.mtx", Written::matrix}}), "");
  expect_refusal("which HDF5 needs", {{"-o", folder / "pipe.h5", Written::matrix}});
  expect_refusal("which HDF5 needs", {{"-o", "/dev/null", Written::scene}});
  EXPECT_EQ(refusal({{"-o", "/dev/null", Written::vmat}}), "");
}

}  // namespace
}  // namespace vismat
