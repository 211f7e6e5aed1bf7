// The options of verbs that make view cells.
#pragma once
#include <CLI/CLI.hpp>

#include "visibility/cells/cells_choice.h"

namespace vismat::cli {

/// --cells, --region, --from and --eyes. `words` must outlive the verb's parsing.
void add_cells_options(CLI::App& verb, CellsWords& words);

}  // namespace vismat::cli
