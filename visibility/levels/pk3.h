// Reads members of a zip archive, such as a .pk3 file.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vismat {

/// Reads the directory at once, and members on request. Every failure is a FormatError, or for a file that cannot be
/// opened a std::runtime_error naming the path. Do not trust what a member says about its size: an archive that claims
/// gigabytes costs at most most_member_bytes of memory.
class Pk3 {
 public:
  static constexpr std::uint64_t most_member_bytes = 256 << 20;  // levels are far smaller

  explicit Pk3(const std::filesystem::path& path);
  explicit Pk3(std::span<const std::byte> bytes);  // borrowed while *this lives

  struct Map {
    std::string name;
    std::uint64_t bytes = 0;  // as the directory claims
  };
  std::vector<Map> maps() const;             // members that end in .bsp, in the archive's order
  std::vector<Map> wads() const;             // members that end in .wad
  std::vector<std::string> scripts() const;  // members that end in .shader, in the archive's order
  /// Whether there is a member of this name: exactly, or else but for upper and lower case and \ for /, which engines
  /// do not tell apart. Throws FormatError if several differ from it only so.
  bool has(const std::string& member) const;
  /// Reads the member that has() finds; if there is none, the message lists the first levels of the archive.
  std::vector<std::byte> read(const std::string& member) const;

 private:
  std::vector<Map> members(std::string_view ending) const;
  std::int64_t find(const std::string& member) const;  // its number, or -1
  struct Archive;
  std::shared_ptr<Archive> archive_;
};

}  // namespace vismat
