// vismat verify: proves row by row that a merged matrix hides nothing that its source shows, or checks entries of a matrix against
// its scene.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "matrix/dataset.h"
#include "matrix/loss.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/exact/audit.h"
#include "visibility/scene_file.h"

namespace vismat::cli {

namespace {

struct VerifyOptions {
  std::filesystem::path matrix, original;
  std::string scene;
  AuditOptions audit;
};

void against_original(const VerifyOptions& options) {
  const Dataset lossy = in_source_numbers(read_any_matrix(options.matrix)),
                original = in_source_numbers(read_any_matrix(options.original));
  Loss loss;
  try {
    loss = loss_of(lossy.matrix, original.matrix);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options.matrix.string() + ": " + error.what());
  }
  if (loss.missing > 0) {
    throw std::runtime_error(options.matrix.string() + ": hides " + grouped(loss.missing) +
                             " visible entries, the first in row " + std::to_string(loss.first_missing->row) +
                             ", column " + std::to_string(loss.first_missing->column));
  }
  line("verified", "row by row: nothing visible is hidden");
  print_loss(loss);
}

void print_side(const char* what, const Audit::Side& side) {
  if (side.checked == 0) return;
  std::printf("%-8s %14s %10s %10s %14s\n", what, grouped(side.entries).c_str(),
              grouped(side.checked).c_str(), grouped(side.confirmed).c_str(),
              grouped(side.checked - side.confirmed).c_str());
}

void against_scene(const VerifyOptions& options) {
  Dataset dataset = read_any_matrix(options.matrix);
  if (dataset.source.row_order || dataset.source.column_order || dataset.source.row_groups ||
      dataset.source.column_groups || dataset.source.list_rows) {
    dataset = in_source_numbers(std::move(dataset));
  }
  const SceneFile file = read_scene(options.scene);
  Audit audit;
  try {
    audit = vismat::audit(dataset, file.scene, file.cells, options.audit, show_progress("checking"));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options.matrix.string() + ": " + error.what());
  }
  std::printf("%-8s %14s %10s %10s %14s\n", "claim", "entries", "checked", "confirmed", "not confirmed");
  print_side("seen", audit.seen);
  print_side("hidden", audit.hidden);
  if (audit.seen.aimed_again > 0) {
    line("aimed again", grouped(audit.seen.aimed_again) +
                            " sight lines, which pass closer to an edge than the rounding error");
  }
  for (const auto& [side, claim] : {std::pair(&audit.seen, "seen"), std::pair(&audit.hidden, "hidden")}) {
    if (!side->first_not_confirmed) continue;
    throw std::runtime_error(options.matrix.string() + ": " + grouped(side->checked - side->confirmed) +
                             " of " + grouped(side->checked) + " entries are not confirmed to be " + claim +
                             ", the first in " + *side->first_not_confirmed);
  }
}

void run_verify(const VerifyOptions& options) {
  if (!options.scene.empty()) {
    against_scene(options);
  } else if (!options.original.empty()) {
    against_original(options);
  } else {
    throw std::invalid_argument("name the ORIGINAL matrix, or a scene with --witness");
  }
}

}  // namespace

void add_verify(Program& program) {
  const auto options = std::make_shared<VerifyOptions>();
  const Verb verb = program.verb("verify",
                                 "Prove that a merged matrix hides nothing visible, or check a matrix "
                                 "against its scene in exact arithmetic");
  verb.input("MATRIX", options->matrix, "The matrix to verify (.bsp.h5, .mtx, .npy, .npz or .vmat)")
      .required();
  const Option original =
      verb.input("ORIGINAL", options->original,
                 "Its source, the matrix that was merged (.bsp.h5, .mtx, .npy, .npz or .vmat)");
  const Option scene =
      verb.input(
              "--witness", options->scene,
              "Check entries against this scene file, by sight lines and occluders, in exact arithmetic; the "
              "matrix must have objects as columns (vismat see --objects)")
          .excludes(original);
  verb.option("--samples", options->audit.entries,
              "Number of entries to check among those said to be seen, and among those said to be hidden")
      .between(1, 1e9)
      .needs(scene);
  verb.option("--points", options->audit.points,
              "Number of points to check of each object that is said to be hidden")
      .between(1, 1e9)
      .needs(scene);
  verb.option("--seed", options->audit.seed, "Another seed checks other entries").needs(scene);
  verb.note(
      "The exit code is 0 if every visible entry is still there, or every checked entry is confirmed. "
      "Otherwise it is 1, and the first entry that failed is named.");
  verb.example("vismat verify merged.bsp.h5 city.bsp.h5");
  verb.example(
      "vismat see city.scene.h5 --objects -o objects.bsp.h5 && vismat verify objects.bsp.h5 --witness "
      "city.scene.h5");
  verb.runs([options] { run_verify(*options); });
}

}  // namespace vismat::cli
