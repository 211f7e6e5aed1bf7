// What people use today, by its own libraries: kept apart so that our codecs link nothing.
#pragma once
#include <string_view>
#include <vector>

#include "codecs/codec.h"

namespace vismat {

/// Whole-file compressors over the byte-aligned bitmap, and what gives rows alone.
std::span<const Codec> baseline_codecs();

/// Codecs that need no tree, baselines after ours, then those over trees: the order of tables.
std::vector<Codec> all_codecs();
/// Throws std::invalid_argument that lists the names.
const Codec& find_codec(std::string_view name);

}  // namespace vismat
