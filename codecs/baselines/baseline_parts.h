// The codecs of each source file of this folder, from which baseline_codecs() is made.
#pragma once
#include <array>

#include "codecs/codec.h"

namespace vismat {

std::array<Codec, 5>
whole_file_baselines();  // whole_file.cpp: the bitmap through gzip, bzip2, xz, zstd, brotli
std::array<Codec, 2> zlib_row_baselines();  // zlib_rows.cpp: gzip-rows, unreal-chunks
std::array<Codec, 2> zstd_row_baselines();  // zstd_rows.cpp: zstd-rows, zstd-dict
Codec roaring_baseline();                   // roaring.cpp
Codec streamvbyte_baseline();               // streamvbyte.cpp

}  // namespace vismat
