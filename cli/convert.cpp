// vismat convert: converts a matrix from one file format to the other.
#include <filesystem>
#include <memory>

#include "cli/verbs.h"
#include "matrix/files/dataset_file.h"
#include "programs/options.h"

namespace vismat::cli {

void add_convert(Program& program) {
  struct Options {
    std::filesystem::path input, output;
  };
  const auto options = std::make_shared<Options>();
  const Verb verb =
      program.verb("convert", "Convert a matrix file between Binsparse on HDF5 and Matrix Market");
  verb.input("MATRIX", options->input,
             "The matrix file to read (.bsp.h5, .h5, .hdf5 or .mtx; its first bytes tell which)")
      .required();
  verb.output(
      options->output, Written::matrix,
      "The matrix file to write (.bsp.h5, .h5, .hdf5, or .mtx, which keeps only the matrix and the facts)");
  verb.example("vismat convert koth1.bsp.h5 -o koth1.mtx");
  verb.runs([options] { write_dataset(options->output, read_dataset(options->input)); });
}

}  // namespace vismat::cli
