// A thin, closed door to the HDF5 library: named arrays and attributes, nothing else of its C interface shows.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vismat {

/// Paths inside the file are absolute ("/vismat/tree/parent"); missing groups are made on writing. Number is one of
/// u8, u32, u64, f32. Every failure throws FormatError naming the path inside the file; HDF5 itself prints nothing.
class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path& path);  // truncates
  static Hdf5File open(const std::filesystem::path& path);    // read only
  Hdf5File(Hdf5File&&) noexcept;
  Hdf5File& operator=(Hdf5File&&) noexcept;
  ~Hdf5File();

  /// Row-major; dimensions multiply to values.size().
  template <typename Number>
  void write(const std::string& name, std::span<const Number> values, std::vector<std::uint64_t> dimensions);
  bool contains(const std::string& name) const;
  std::vector<std::uint64_t> dimensions(const std::string& name) const;
  /// Converts from the stored integer or float type; refuses a value that does not fit, and a dataset larger than
  /// the file could hold.
  template <typename Number>
  std::vector<Number> read(const std::string& name) const;

  void write_attribute(const std::string& object, const std::string& name, const std::string& value);
  void write_attribute(const std::string& object, const std::string& name, std::uint64_t value);
  std::optional<std::string> string_attribute(const std::string& object, const std::string& name) const;
  std::optional<std::uint64_t> number_attribute(const std::string& object, const std::string& name) const;

 private:
  struct Handle;
  explicit Hdf5File(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
};

}  // namespace vismat
