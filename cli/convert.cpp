// vismat convert: converts a matrix from one file format to another.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "matrix/files/dataset_file.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct ConvertOptions {
  std::filesystem::path input, output;
};

void run_convert(const ConvertOptions& options) {
  MatrixNotes notes;
  const Dataset data = read_dataset(options.input, &notes);
  write_dataset(options.output, data);
  std::printf("%s: %u x %u, %llu ones", options.output.c_str(), data.matrix.shape().rows,
              data.matrix.shape().columns, static_cast<unsigned long long>(data.matrix.ones()));
  const std::string left_out = left_out_in(options.output, data);
  for (const std::string& text : {notes.text(), left_out.empty() ? "" : "without " + left_out}) {
    if (!text.empty()) std::printf("; %s", text.c_str());
  }
  std::printf("\n");
}

}  // namespace

void add_convert(Program& program) {
  const auto options = std::make_shared<ConvertOptions>();
  const Verb verb = program.verb(
      "convert", "Convert a matrix file between Binsparse on HDF5, Matrix Market, NumPy and SciPy");
  verb.input("MATRIX", options->input,
             "The matrix file to read: .bsp.h5, .h5, .hdf5, .mtx, .npy or .npz, all but HDF5 also gzipped "
             "(.gz). Its first bytes tell which. FILE.h5:GROUP names a group of an HDF5 file, "
             "FILE.npy:COLUMNS the columns of bits that numpy.packbits packed")
      .required();
  verb.output(options->output, Written::matrix,
              "The matrix file to write: .bsp.h5, .h5 or .hdf5; .mtx, which keeps only the matrix and the "
              "facts; .npy (an array of booleans) or .npz (for scipy.sparse.load_npz), which keep only the "
              "matrix");
  verb.example("vismat convert koth1.bsp.h5 -o koth1.mtx");
  verb.runs([options] { run_convert(*options); });
}

}  // namespace vismat::cli
