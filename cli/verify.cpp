// verify: the proof, row by row, that a lossy matrix hides nothing that its original shows.
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "matrix/dataset.h"
#include "matrix/loss.h"

namespace vismat::cli {

void add_verify(CLI::App& app) {
  struct Options {
    std::filesystem::path lossy, original;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("verify", "Prove that a lossy matrix hides nothing that its original shows");
  verb->add_option("LOSSY", options->lossy, "What was merged, ordered or encoded: .bsp.h5, .mtx or .vmat")->required();
  verb->add_option("ORIGINAL", options->original, "What it was made of: .bsp.h5, .mtx or .vmat")->required();
  verb->footer(
      "Exit 0: every visible entry is still there. Exit 1: some are not; the first is named.\n"
      "Example: vismat verify merged.bsp.h5 city.bsp.h5");
  verb->callback([options] {
    const Dataset lossy = in_source_numbers(read_any_matrix(options->lossy)),
                  original = in_source_numbers(read_any_matrix(options->original));
    Loss loss;
    try {
      loss = loss_of(lossy.matrix, original.matrix);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(options->lossy.string() + ": " + error.what());
    }
    if (loss.missing > 0) {
      throw std::runtime_error(options->lossy.string() + ": hides " + grouped(loss.missing) +
                               " visible entries, the first in row " + std::to_string(loss.first_missing->row) +
                               ", column " + std::to_string(loss.first_missing->column));
    }
    line("verified", "row by row, nothing visible is hidden");
    print_loss(loss);
  });
}

}  // namespace vismat::cli
