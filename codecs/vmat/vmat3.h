// `.vmat` version 3, the format of 2026: read by 'vismat decode' alone, so that what was written in it is not lost. docs/vmat3.md
// gives the layout.
#pragma once
#include <cstddef>
#include <span>

#include "codecs/vmat/container.h"

namespace vismat {

/// Whether the bytes say that they are a file of version 3.
bool is_vmat3(std::span<const std::byte> file);

/// What a file of version 3 holds, its index in today's form. `codecs` tells what kind of index its codec has. Throws FormatError
/// on bytes that no writer of version 3 made.
Container read_vmat3(std::span<const std::byte> file, std::span<const Codec> codecs);

/// As seal_container, for a fuzzer of this format.
void seal_vmat3(std::span<std::byte> file);

}  // namespace vismat
