// Writes files that appear under their final name whole or not at all.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace vismat {

/// Write to partial_path(), then commit(): the finished file takes its final name in one step. Without commit (an
/// exception, Ctrl-C, see remove_partial_files) the partial file is removed and what stood there before stays.
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

/// Removes every partial file now open; async-signal-safe, so a handler of SIGINT may call it before _exit.
void remove_partial_files() noexcept;

/// The whole file. Throws std::runtime_error naming the path and the system's reason.
std::vector<std::byte> read_file(const std::filesystem::path& path);
/// By way of an AtomicFile.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace vismat
