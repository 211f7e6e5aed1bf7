#include "programs/names.h"

namespace vismat {

std::string matrix_name(const std::filesystem::path& file) {
  const std::string name = file.filename();
  const std::size_t end = name.find(".bsp.h5");
  return end == std::string::npos ? file.stem().string() : name.substr(0, end);
}

std::string scene_name(const std::string& where) {
  return std::filesystem::path(where.substr(where.rfind(':') + 1)).stem();
}

}  // namespace vismat
