// Files that appear under their final name completely or not at all.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace vismat {

/// A file that is being written. Write to partial_path(), then call commit(): the finished file takes its final name in
/// one step. Without commit (after an exception, or Ctrl-C, see remove_partial_files) the partial file is removed and
/// what stood under the final name before stays.
class AtomicFile {
 public:
  /// Throws std::runtime_error if the folder does not exist or cannot be written to.
  explicit AtomicFile(std::filesystem::path final_path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  const std::filesystem::path& partial_path() const { return partial_; }
  void commit();  // throws std::runtime_error if the rename fails

 private:
  void release_slot();
  std::filesystem::path final_, partial_;
  int slot_ = -1;  // in the list that remove_partial_files walks
};

/// Removes every partial file that is open now. It is async-signal-safe, so a handler of SIGINT may call it before
/// _exit.
void remove_partial_files() noexcept;

/// Reads the whole file. Throws std::runtime_error naming the path and the system's reason.
std::vector<std::byte> read_file(const std::filesystem::path& path);
/// Writes the whole file by way of an AtomicFile.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace vismat
