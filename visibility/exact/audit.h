// Checks a sample of a matrix's entries against the scene.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "matrix/base/parallel.h"
#include "matrix/dataset.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

struct AuditOptions {
  std::uint32_t entries = 200;   // of those that say seen, and of those that say hidden
  std::uint32_t points = 16;     // of an object that is said to be hidden
  std::uint64_t rays = 10'000;   // at an object that is said to be seen, where no sight line is given
  std::uint32_t patches = 1000;  // of a cell from which an object is said to be hidden, at most
  std::uint64_t seed = 1;
};

struct Audit {
  struct Side {
    std::uint64_t entries = 0;  // that claim it
    std::uint64_t checked = 0, confirmed = 0;
    std::uint64_t aimed_again = 0;                   // of the confirmed, see WitnessCheck::seen
    std::optional<std::string> first_not_confirmed;  // "row 3, column 7: why"
  };
  Side seen, hidden;
};

/// Takes entries at random, finds what proves each and checks that by WitnessCheck. A sampled or exact matrix claims that its
/// entries are seen: by its own sight lines, or else by rays aimed anew. A conservative or exact one claims that the others
/// are hidden: what hides them is sought anew with small patches of the cell, so that what fails is found with less effort
/// too. Not confirmed is not refuted: of the proof that an entry had when it was made, sight lines alone are kept.
/// Throws std::invalid_argument for a matrix without guarantee, over nodes, or of another size than cells x objects.
Audit audit(const Dataset& dataset, const Scene& scene, const ViewCells& cells,
            const AuditOptions& options = {}, const Progress& progress = {});

}  // namespace vismat
