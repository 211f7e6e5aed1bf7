#include "matrix/base/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>

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

using Written = AtomicFile::Written;

TEST(AtomicFile, AppearsOnlyOnCommit) {
  for (const Written written : {Written::in_order, Written::by_name}) {
    const TemporaryFolder folder;
    write_file(folder / "a", bytes_of("before"));
    {
      AtomicFile file(folder / "a", written);
      file.write(bytes_of("half"));
      EXPECT_EQ(text_of(folder / "a"), "before");
      if (written == Written::by_name) {
        EXPECT_EQ(text_of(file.partial_path()), "half");
      }
    }
    EXPECT_EQ(text_of(folder / "a"), "before");
    EXPECT_EQ(folder.entries(), 1u);
    AtomicFile file(folder / "a", written);
    file.write(bytes_of("after"));
    file.commit();
    EXPECT_EQ(text_of(folder / "a"), "after");
    EXPECT_EQ(folder.entries(), 1u);
  }
}

TEST(AtomicFile, WritersOfOneFileDoNotMeet) {
  for (const Written written : {Written::in_order, Written::by_name}) {
    const TemporaryFolder folder;
    AtomicFile first(folder / "a", written), second(folder / "a", written);
    first.write(bytes_of("the first, which is longer"));
    second.write(bytes_of("the second"));
    first.commit();
    EXPECT_EQ(text_of(folder / "a"), "the first, which is longer");
    second.commit();
    EXPECT_EQ(text_of(folder / "a"), "the second");
    EXPECT_EQ(folder.entries(), 1u);
  }
}

TEST(AtomicFile, RemovesWhatAKilledWriterLeft) {
  const TemporaryFolder folder;
  AtomicFile living(folder / "a", Written::by_name);
  for (const char* name : {"a.partial-abcdef", "a.partial-mine", "ab.partial-abcdef"})
    write_file(folder / name, bytes_of("half"));
  AtomicFile next(folder / "a", Written::by_name);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.partial-abcdef"));
  EXPECT_EQ(folder.entries(), 4u);  // both that are being written, and two that are no leftovers of this file
  living.commit();
}

TEST(AtomicFile, KeepsTheRightsOfTheOldFile) {
  for (const Written written : {Written::in_order, Written::by_name}) {
    const TemporaryFolder folder;
    write_file(folder / "a", bytes_of("before"));
    ASSERT_EQ(::chmod((folder / "a").c_str(), 0606), 0);
    const bool root = ::geteuid() == 0;
    if (root) {
      ASSERT_EQ(::chown((folder / "a").c_str(), 12, 34), 0);
    }
    AtomicFile file(folder / "a", written);
    file.commit();
    struct stat status {};
    ASSERT_EQ(::stat((folder / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0606u);
    EXPECT_EQ(status.st_size, 0);
    if (root) {
      EXPECT_EQ(status.st_uid, 12u);
      EXPECT_EQ(status.st_gid, 34u);
    } else {
      ASSERT_EQ(::chmod((folder / "a").c_str(), 0400), 0);
      EXPECT_THROW(AtomicFile(folder / "a", written), std::runtime_error);
    }
  }
}

TEST(AtomicFile, WritesWhereALinkPoints) {
  const TemporaryFolder folder, other;
  std::filesystem::create_symlink(other / "target", folder / "middle");
  std::filesystem::create_symlink("middle", folder / "link");
  for (const char* text : {"new", "again"}) {
    write_file(folder / "link", bytes_of(text));
    EXPECT_EQ(text_of(other / "target"), text);
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "middle"));
  }
  std::filesystem::create_symlink("circle", folder / "circle");
  EXPECT_THROW(write_file(folder / "circle", bytes_of("x")), std::runtime_error);
}

TEST(AtomicFile, WritesIntoDevicesPipesAndDescriptors) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = text_of(folder / "pipe"); });
  write_file(folder / "pipe", bytes_of("through the pipe"));
  reader.join();
  EXPECT_EQ(got, "through the pipe");
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
  write_file("/dev/null", bytes_of("nothing"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_THROW(AtomicFile("/dev/null", Written::by_name), std::runtime_error);
  try {
    write_file("/dev/full", bytes_of("too much"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/dev/full: cannot write: No space left on device");
  }
  const int file = ::open((folder / "list").c_str(), O_CREAT | O_WRONLY, 0600);
  ASSERT_EQ(::write(file, "first, ", 7), 7);
  write_file("/dev/fd/" + std::to_string(file), bytes_of("then"));
  ::close(file);
  EXPECT_EQ(text_of(folder / "list"), "first, then");
}

TEST(AtomicFile, StreamsAnyAmountAndTellsAFullDisk) {
  const TemporaryFolder folder;
  std::string all;
  AtomicFile file(folder / "a");
  AtomicFileStream stream(file);
  for (int i = 0; i < 50000; ++i) {
    stream << i << '\n';
    all += std::to_string(i) + '\n';
  }
  stream.flush();
  file.commit();
  EXPECT_EQ(text_of(folder / "a"), all);
  AtomicFile full("/dev/full");
  AtomicFileStream fails(full);
  EXPECT_THROW(fails << all, std::runtime_error);
}

TEST(AtomicFile, SignalHandlersCanRemoveWhatIsHalfWritten) {
  const TemporaryFolder folder;
  AtomicFile first(folder / "a", Written::by_name), second(folder / "b", Written::by_name),
      third(folder / "c");
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
