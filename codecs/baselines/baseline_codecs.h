// The codecs that others use, through their own libraries. They form a separate library, so that vismat::codecs needs
// none of those libraries.
#pragma once
#include <string_view>
#include <vector>

#include "codecs/codec.h"

namespace vismat {

/// Whole-file compressors over the byte-aligned bitmap, and row codecs.
std::span<const Codec> baseline_codecs();

/// All codecs in the order of tables: ours without a tree, the baselines, then the tree codecs.
std::vector<Codec> all_codecs();
/// The codec of that name. Throws std::invalid_argument, which lists the names.
const Codec& find_codec(std::string_view name);

}  // namespace vismat
