// Compressors that exist as programs under the GPL: run, never linked. For comparisons alone: they are no codecs of a .vmat
// file that goes anywhere, since a reader would have to have them, and were not written for a stranger's bytes.
#pragma once
#include <vector>

#include "codecs/codec.h"

namespace vismat {

/// zpaq and jbig1, over the whole bitmap. Each call runs the program in a folder of its own under the system's temporary
/// one, quietly and without a shell, and removes it. Same input, same bytes. encode throws std::runtime_error where the
/// program fails; decode FormatError on payloads that the program refuses, or that are no matrix of the shape; both
/// std::runtime_error, naming the Debian package, where the program is missing.
std::span<const Codec> program_codecs();

/// Those of program_codecs() that find what they run.
std::vector<Codec> available_program_codecs();

}  // namespace vismat
