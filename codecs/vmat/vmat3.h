// `.vmat` version 3, the format before version 4. Only `vismat decode` reads it, so that files in it are not lost.
// docs/vmat3.md gives the layout.
#pragma once
#include <cstddef>
#include <span>

#include "codecs/vmat/container.h"

namespace vismat {

/// Whether the bytes begin as a file of version 3 does.
bool is_vmat3(std::span<const std::byte> file);

/// The content of a file of version 3, with its index in the present form. `codecs` says what kind of index its codec
/// has. Throws FormatError on bytes that no writer of version 3 made.
Container read_vmat3(std::span<const std::byte> file, std::span<const Codec> codecs);

/// Like seal_container, for a fuzzer of this format.
void seal_vmat3(std::span<std::byte> file);

}  // namespace vismat
