// Finds in Quake 3 shader scripts the surfaces that one can see through, which the level's own flags do not tell.
#pragma once
#include <set>
#include <string>
#include <string_view>

namespace vismat {

/// Adds the names, in lower case, of the script's shaders through which one may see: a stage has an alphaFunc (holes), the first
/// stage a blendFunc (mixed with what is behind), or surfaceparm trans. Takes any text, as the engine does.
void add_see_through_shaders(std::string_view script, std::set<std::string>& names);

}  // namespace vismat
