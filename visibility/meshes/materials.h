// Tells which materials of an OBJ file can be seen through.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace vismat {

struct Materials {
  /// For each material that is defined what makes it see-through, such as "d 0.1"; empty if it is opaque.
  std::map<std::string, std::string> see_through;
  std::vector<std::string> missing;  // material files and textures that cannot be read
};

/// Whether an image has an alpha channel or a transparent colour, by its header alone: PNG, TGA, DDS and WebP, which are told by
/// their first bytes (TGA by `name`). Other images, JPEG among them, have none.
bool has_alpha(std::span<const std::byte> image, const std::filesystem::path& name);

/// Adds the materials of an MTL text. See-through are those with `d` below 1, `Tr` above 0 (but not `d 1` and `Tr 1` together,
/// as programs write it that take Tr for opacity), with a map_d, or with a map_Kd or map_Ka whose image has alpha. Textures are
/// looked for in `folder`. Lines that it does not know are left alone, since most of them are about colours.
void add_materials(std::span<const std::byte> text, const std::filesystem::path& folder,
                   Materials& materials);

}  // namespace vismat
