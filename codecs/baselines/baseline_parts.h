// What baseline_codecs() is put together from; a source file each.
#pragma once
#include <array>

#include "codecs/codec.h"

namespace vismat {

std::array<Codec, 5>
whole_file_baselines();  // baseline_whole_file.cpp: the bitmap through gzip, bzip2, xz, zstd, brotli
std::array<Codec, 2> zlib_row_baselines();  // baseline_zlib_rows.cpp: gzip-rows, unreal-chunks
std::array<Codec, 2> zstd_row_baselines();  // baseline_zstd_rows.cpp: zstd-rows, zstd-dict
Codec roaring_baseline();                   // baseline_roaring.cpp
Codec streamvbyte_baseline();               // baseline_streamvbyte.cpp

}  // namespace vismat
