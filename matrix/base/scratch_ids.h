// An array of ids, billions of them, that lies on disk instead of in memory.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>

namespace vismat {

/// An array of ids in a temporary file without a name, so that nothing is left of it however the program ends. It is
/// written from front to back and then read through the system's page cache, which gives memory back when others need
/// it.
class ScratchIds {
 public:
  ScratchIds() = default;
  /// An empty array in `folder`. Throws std::runtime_error, as append and map do, naming the folder and the system's
  /// reason.
  explicit ScratchIds(std::filesystem::path folder);
  ~ScratchIds();
  ScratchIds(ScratchIds&& other) noexcept { swap(other); }
  ScratchIds& operator=(ScratchIds&& other) noexcept {
    swap(other);
    return *this;
  }

  void append(std::span<const std::uint32_t> ids);
  /// Ends writing and makes ids() readable.
  void map();
  std::span<const std::uint32_t> ids() const { return {data_, size_}; }

 private:
  void swap(ScratchIds& other) noexcept;
  std::filesystem::path folder_;
  int file_ = -1;
  const std::uint32_t* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace vismat
