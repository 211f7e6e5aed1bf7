// Compressors that exist only as programs under the GPL. They are run, never linked, and serve comparisons alone. They
// are no codecs of .vmat files: a reader would have to have the programs, which were not written for untrusted bytes.
#pragma once
#include <vector>

#include "codecs/codec.h"

namespace vismat {

/// zpaq and jbig1, over the whole bitmap. Each call runs the program without a shell in a temporary folder of its own
/// and removes the folder. The same input gives the same bytes. encode throws std::runtime_error if the program fails.
/// decode throws FormatError on payloads that the program refuses or that do not hold a matrix of the shape. Both throw
/// std::runtime_error, which names the Debian package, if the program is not installed.
std::span<const Codec> program_codecs();

/// Those of program_codecs() whose programs are installed.
std::vector<Codec> available_program_codecs();

}  // namespace vismat
