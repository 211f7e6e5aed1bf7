// The names that matrices, levels and other scenes have in tables.
#pragma once
#include <filesystem>
#include <string>

namespace vismat {

/// The matrix's name: "artificial-1" of "out/matrices/artificial-1.bsp.h5", "small" of "small.mtx".
std::string matrix_name(const std::filesystem::path& file);

/// The scene's name: "oa_koth1" of "pak1-maps.pk3:maps/oa_koth1.bsp"; "E1M1" of "doom.wad:E1M1"; "plant" of "plant".
std::string scene_name(const std::string& where);

}  // namespace vismat
