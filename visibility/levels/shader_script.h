// What Quake-3 shader scripts say of surfaces that the level's own flags do not.
#pragma once
#include <set>
#include <string>
#include <string_view>

namespace vismat {

/// Adds the names, in lower case, of the script's shaders through which one may see: a stage has an alphaFunc (holes), the first
/// stage a blendFunc (mixed with what is behind), or surfaceparm trans. Takes any text, as the engine does.
void add_see_through_shaders(std::string_view script, std::set<std::string>& names);

}  // namespace vismat
