#include "visibility/meshes/materials.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>

#include "matrix/base/byte_reader.h"
#include "visibility/levels/ascii.h"

namespace vismat {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? "" : std::string(text.substr(first, last - first + 1));
}

bool png_has_alpha(std::span<const std::byte> image) {
  const auto colour = std::to_integer<unsigned>(image[25]);
  if (colour == 4 || colour == 6) return true;
  for (std::size_t at = 8; at + 8 <= image.size();) {  // a transparent colour stands before the pixels
    const std::string_view chunk(reinterpret_cast<const char*>(&image[at + 4]), 4);
    if (chunk == "tRNS") return true;
    if (chunk == "IDAT") return false;
    at += std::size_t{__builtin_bswap32(number_at<std::uint32_t>(image, at))} + 12;
  }
  return false;
}

/// The image that a texture statement names, behind its options, in the folder; empty if it is not there.
std::filesystem::path texture(const std::string& statement, const std::filesystem::path& folder) {
  std::vector<std::string> names = {statement};  // names may hold blanks
  for (std::size_t at = 0; (at = statement.find(' ', at)) != std::string::npos; ++at) {
    names.push_back(trimmed(statement.substr(at)));
  }
  std::error_code ignored;
  for (std::string name : names) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const std::filesystem::path path(name);
    for (const auto& place : {folder / path, folder / path.filename()}) {
      if (std::filesystem::is_regular_file(place, ignored)) return place;
    }
  }
  return {};
}

struct Definition {
  std::string name, map;  // map: what a texture says
  std::optional<double> opacity, transparency;

  std::string see_through() const {
    if (opacity && *opacity < 1) return "d " + shorter(*opacity);
    const bool is_opacity = opacity && transparency && *transparency == 1;
    if (transparency && *transparency > 0 && !is_opacity) return "Tr " + shorter(*transparency);
    return map;
  }
  static std::string shorter(double number) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%g", number);
    return text.data();
  }
};

}  // namespace

bool has_alpha(std::span<const std::byte> image, const std::filesystem::path& name) {
  const std::string_view start(reinterpret_cast<const char*>(image.data()), image.size());
  if (start.starts_with("\x89PNG\r\n\x1a\n")) return image.size() > 25 && png_has_alpha(image);
  if (start.starts_with("DDS ") && image.size() >= 128) {
    constexpr std::uint32_t alpha_pixels = 1, four_letters = 4;
    const std::uint32_t flags = number_at<std::uint32_t>(image, 80);
    const std::string_view code = start.substr(84, 4);
    const bool packed =
        (flags & four_letters) != 0 && code != "ATI1" && code != "ATI2" && code != "BC4U" && code != "BC5U";
    return (flags & alpha_pixels) != 0 || packed;  // DXT1 too may have transparent pixels
  }
  if (start.starts_with("RIFF") && image.size() > 24 && start.substr(8, 4) == "WEBP") {
    if (start.substr(12, 4) == "VP8X") return (std::to_integer<unsigned>(image[20]) & 0x10) != 0;
    return start.substr(12, 4) == "VP8L" && (std::to_integer<unsigned>(image[24]) & 0x10) != 0;
  }
  return ascii_lower(name.extension().string()) == ".tga" && image.size() >= 18 &&
         (std::to_integer<unsigned>(image[16]) == 32 || (std::to_integer<unsigned>(image[17]) & 15) != 0);
}

void add_materials(std::span<const std::byte> text, const std::filesystem::path& folder,
                   Materials& materials) {
  std::string lines(reinterpret_cast<const char*>(text.data()), text.size());
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  if (lines.starts_with("\xef\xbb\xbf")) lines.erase(0, 3);
  std::optional<Definition> current;
  const auto finish = [&] {
    if (current) materials.see_through[current->name] = current->see_through();
  };
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    line = trimmed(line);
    const auto blank = std::min(line.find_first_of(" \t"), line.size());
    const std::string keyword = ascii_lower(line.substr(0, blank)), rest = trimmed(line.substr(blank));
    if (keyword == "newmtl") {
      finish();
      current = Definition{rest, "", {}, {}};
    } else if (!current) {
      continue;
    } else if (keyword == "d" || keyword == "tr") {
      const std::string number = rest.starts_with("-halo") ? trimmed(rest.substr(5)) : rest;
      (keyword == "d" ? current->opacity : current->transparency) = std::strtod(number.c_str(), nullptr);
    } else if (keyword == "map_d" || keyword == "map_tr" || keyword == "map_opacity") {
      current->map = keyword;
    } else if ((keyword == "map_kd" || keyword == "map_ka") && current->map.empty()) {
      const std::filesystem::path image = texture(rest, folder);
      std::ifstream file(image, std::ios::binary);
      if (image.empty() || !file) {
        materials.missing.push_back(rest);
        continue;
      }
      std::vector<char> head(65536);  // what stands before the pixels
      file.read(head.data(), static_cast<std::streamsize>(head.size()));
      head.resize(static_cast<std::size_t>(file.gcount()));
      if (has_alpha(std::as_bytes(std::span(head)), image))
        current->map = image.filename().string() + " has alpha";
    }
  }
  finish();
}

}  // namespace vismat
