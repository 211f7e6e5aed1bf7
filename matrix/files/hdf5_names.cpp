#include "matrix/files/hdf5_names.h"

#include <algorithm>
#include <cstdint>

#include "matrix/base/byte_reader.h"

namespace vismat {

std::vector<std::string> read_names(const Hdf5File& file, const std::string& name) {
  if (!file.contains(name)) return {};
  const std::vector<std::uint8_t> bytes = file.read<std::uint8_t>(name);
  if (bytes.empty() || bytes.back() != 0)
    throw FormatError(name + ": must be names with a zero byte behind each");
  std::vector<std::string> names;
  for (auto at = bytes.begin(); at != bytes.end();) {
    const auto end = std::find(at, bytes.end(), std::uint8_t{0});
    names.emplace_back(at, end);
    at = end + 1;
  }
  return names;
}

void write_names(Hdf5File& file, const std::string& name, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::vector<std::uint8_t> bytes;
  for (const std::string& n : names) {
    bytes.insert(bytes.end(), n.begin(), n.end());
    bytes.push_back(0);
  }
  file.write<std::uint8_t>(name, bytes, {bytes.size()});
}

}  // namespace vismat
