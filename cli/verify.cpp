// verify: the proof, row by row, that a lossy matrix hides nothing that its original shows; and proofs, entry by entry, that a
// matrix shows and hides what its scene does.
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
#include "programs/progress.h"
#include "visibility/exact/audit.h"
#include "visibility/scene_file.h"

namespace vismat::cli {

namespace {

struct Options {
  std::filesystem::path matrix, original;
  std::string scene;
  AuditOptions audit;
};

void against_original(const Options& options) {
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
  line("verified", "row by row, nothing visible is hidden");
  print_loss(loss);
}

void print_side(const char* what, const Audit::Side& side) {
  if (side.checked == 0) return;
  std::printf("%-8s %14s %10s %10s %14s\n", what, grouped(side.entries).c_str(),
              grouped(side.checked).c_str(), grouped(side.confirmed).c_str(),
              grouped(side.checked - side.confirmed).c_str());
}

void against_scene(const Options& options) {
  Dataset dataset = read_any_matrix(options.matrix);
  if (dataset.source.row_order || dataset.source.column_order || dataset.source.row_groups ||
      dataset.source.column_groups) {
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
    line("aimed again",
         grouped(audit.seen.aimed_again) + " sight lines, which pass an edge closer than rounding");
  }
  for (const auto& [side, claim] : {std::pair(&audit.seen, "seen"), std::pair(&audit.hidden, "hidden")}) {
    if (!side->first_not_confirmed) continue;
    throw std::runtime_error(options.matrix.string() + ": " + grouped(side->checked - side->confirmed) +
                             " of " + grouped(side->checked) + " entries are not confirmed to be " + claim +
                             ", the first in " + *side->first_not_confirmed);
  }
}

}  // namespace

void add_verify(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "verify",
      "Prove that a lossy matrix hides nothing that its original shows, or check a matrix against its scene");
  verb->add_option("MATRIX", options->matrix, "The matrix in question: .bsp.h5, .mtx or .vmat")->required();
  CLI::Option* original =
      verb->add_option("ORIGINAL", options->original, "What it was made of: .bsp.h5, .mtx or .vmat");
  CLI::Option* scene =
      verb->add_option("--witness", options->scene,
                       "Check entries against this scene file, by sight lines and occluders, exactly");
  scene->excludes(original);
  const auto add = [&](const char* name, auto& value, const char* help) {
    verb->add_option(name, value, help)->capture_default_str()->needs(scene);
  };
  add("--samples", options->audit.entries,
      "Entries to check, of those that say seen and of those that say hidden");
  add("--points", options->audit.points, "Points of each object that is said to be hidden");
  add("--seed", options->audit.seed, "Another seed, other entries");
  verb->footer(
      "Exit 0: every visible entry is still there, or every checked entry is confirmed. Exit 1: some are "
      "not; the first is\n"
      "named.\n"
      "Example: vismat verify merged.bsp.h5 city.bsp.h5\n"
      "         vismat verify city.bsp.h5 --witness city.scene.h5");
  verb->callback([options] {
    if (!options->scene.empty()) {
      against_scene(*options);
    } else if (!options->original.empty()) {
      against_original(*options);
    } else {
      throw std::invalid_argument("verify: name the ORIGINAL matrix, or a scene with --witness");
    }
  });
}

}  // namespace vismat::cli
