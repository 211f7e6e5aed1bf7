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
  std::uint32_t entries = 200;   // of those that claim seen, and of those that claim hidden
  std::uint32_t points = 16;     // of each object that is claimed to be hidden
  std::uint64_t rays = 10'000;   // at each object that is claimed to be seen, if no sight line is given
  std::uint32_t patches = 1000;  // at most, of a cell from which an object is claimed to be hidden
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

/// Draws entries at random, finds a proof for each, and checks it by WitnessCheck. A sampled or exact matrix claims
/// that its entries are seen; the proof is its own sight line, or else a ray that is aimed anew. A conservative or
/// exact matrix claims that the other entries are hidden; what hides them is sought anew with small patches of the
/// cell, and so with more effort than the matrix took. An entry that is not confirmed may still be right: of the
/// original proofs only sight lines are stored. Throws std::invalid_argument for a matrix without guarantee, over
/// nodes or levels of detail, or of another size than cells x objects.
Audit audit(const Dataset& dataset, const Scene& scene, const ViewCells& cells,
            const AuditOptions& options = {}, const Progress& progress = {});

}  // namespace vismat
