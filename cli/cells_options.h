// The options of the verbs that make view cells.
#pragma once
#include "programs/options.h"
#include "visibility/cells/cells_choice.h"

namespace vismat::cli {

/// Adds the options --cells, --region, --from and --eyes. `words` must outlive the verb's run.
void add_cells_options(const Verb& verb, CellsWords& words);

}  // namespace vismat::cli
