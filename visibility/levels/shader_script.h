// Finds, in Quake 3 shader scripts, the surfaces that one can see through although the level's own flags do not say so.
#pragma once
#include <set>
#include <string>
#include <string_view>

namespace vismat {

/// A shader's name as it is compared: in lower case, with / for \, and without .tga or another ending.
std::string shader_key(std::string_view name);

/// Adds the shader_key of those shaders of the script that one can see through: a stage has an alphaFunc (holes), the
/// first stage has a blendFunc (it is mixed with what is behind), or there is `surfaceparm trans`. Words may stand in
/// quotes. Takes any text, as the engine does.
void add_see_through_shaders(std::string_view script, std::set<std::string>& names);

}  // namespace vismat
