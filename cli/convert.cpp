// vismat convert: a matrix from one file format to the other.
#include <filesystem>
#include <memory>

#include "cli/verbs.h"
#include "matrix/files/dataset_file.h"

namespace vismat::cli {

void add_convert(CLI::App& app) {
  struct Options {
    std::filesystem::path input, output;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("convert", "Binsparse on HDF5 to Matrix Market, and back");
  verb->add_option("MATRIX", options->input,
                   "matrix to read: .bsp.h5, .h5, .hdf5 or .mtx, told by its first bytes")
      ->required();
  verb->add_option("-o,--output", options->output,
                   "where to write: .bsp.h5, .h5, .hdf5, or .mtx, which keeps the matrix and the facts only")
      ->required();
  verb->footer("Example: vismat convert koth1.bsp.h5 -o koth1.mtx");
  verb->callback([options] { write_dataset(options->output, read_dataset(options->input)); });
}

}  // namespace vismat::cli
