// What baseline_codecs() is put together from; a source file each.
#pragma once
#include <array>

#include "codecs/codec.h"

namespace vismat {

std::array<Codec, 5>
whole_file_baselines();  // baseline_whole_file.cpp: the bitmap through gzip, bzip2, xz, zstd, brotli

}  // namespace vismat
