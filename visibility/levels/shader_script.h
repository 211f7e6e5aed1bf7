// Finds, in Quake 3 shader scripts, the surfaces that one can see through although the level's own flags do not say so.
#pragma once
#include <set>
#include <string>
#include <string_view>

namespace vismat {

/// Adds the names, in lower case, of those shaders of the script that one can see through: a stage has an alphaFunc
/// (holes), the first stage has a blendFunc (it is mixed with what is behind), or there is `surfaceparm trans`. Takes
/// any text, as the engine does.
void add_see_through_shaders(std::string_view script, std::set<std::string>& names);

}  // namespace vismat
