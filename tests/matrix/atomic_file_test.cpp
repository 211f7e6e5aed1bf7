#include "matrix/base/atomic_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

std::string text_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

TEST(AtomicFile, AppearsOnlyOnCommit) {
  const TemporaryFolder folder;
  write_file(folder / "a", bytes_of("before"));
  {
    AtomicFile file(folder / "a");
    std::ofstream(file.partial_path()) << "half";
    EXPECT_EQ(text_of(folder / "a"), "before");
    EXPECT_EQ(folder.entries(), 2u);
  }
  EXPECT_EQ(text_of(folder / "a"), "before");
  EXPECT_EQ(folder.entries(), 1u);
  AtomicFile file(folder / "a");
  std::ofstream(file.partial_path()) << "after";
  file.commit();
  EXPECT_EQ(text_of(folder / "a"), "after");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, SignalHandlersCanRemoveWhatIsHalfWritten) {
  const TemporaryFolder folder;
  AtomicFile first(folder / "a"), second(folder / "b");
  EXPECT_EQ(folder.entries(), 2u);
  remove_partial_files();
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(AtomicFile, SaysWhichFileAndWhy) {
  const TemporaryFolder folder;
  try {
    write_file(folder / "missing/x", bytes_of("x"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("missing/x"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos);
  }
  EXPECT_THROW(read_file(folder / "x"), std::runtime_error);
  EXPECT_THROW(read_file(folder / ""), std::runtime_error);  // a folder
}

}  // namespace
}  // namespace vismat
