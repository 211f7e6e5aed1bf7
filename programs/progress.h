// How far long work has come, on stderr.
#pragma once
#include <chrono>
#include <string>

#include "matrix/base/parallel.h"

namespace vismat::cli {

/// On a terminal one line that is redrawn, with time left; elsewhere a plain line every ten seconds. Nothing at all
/// for work that ends within a second.
Progress show_progress(std::string what);

}  // namespace vismat::cli
