// Shows on stderr how far long work has come.
#pragma once
#include <chrono>
#include <string>

#include "matrix/base/parallel.h"

namespace vismat::cli {

/// Shows the progress of `what`: on a terminal as one line that is redrawn, with the time left; elsewhere as a plain
/// line every ten seconds. Prints nothing for work that ends within a second.
Progress show_progress(std::string what);

}  // namespace vismat::cli
