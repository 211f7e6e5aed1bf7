// vismat decode: restores the matrix of a .vmat file.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "matrix/files/dataset_file.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct DecodeOptions {
  std::filesystem::path in, out, boxes;
  bool as_stored = false;
};

void run_decode(const DecodeOptions& options) {
  Dataset boxes;
  if (!options.boxes.empty()) boxes = read_dataset(options.boxes);
  Dataset data = read_vmat_of_any_version(options.in, {nullptr, boxes.row_bounds, boxes.column_bounds});
  if (!options.as_stored) data = in_source_order(std::move(data));
  write_matrix(options.out, data);
  std::printf("%s: %u x %u, %llu ones\n", options.out.c_str(), data.matrix.shape().rows,
              data.matrix.shape().columns, static_cast<unsigned long long>(data.matrix.ones()));
}

}  // namespace

void add_decode(Program& program) {
  const auto options = std::make_shared<DecodeOptions>();
  const Verb verb = program.verb("decode", "Restore the matrix of a .vmat file, in the order of its source");
  verb.input("FILE", options->in, "The .vmat file to read, of version 4 or 3").required();
  verb.output(options->out, Written::matrix, "The matrix file to write (.bsp.h5, .mtx, .npy or .npz)");
  verb.flag("--as-stored", options->as_stored, "Leave rows and columns in the order of the .vmat file");
  verb.input(
      "--boxes", options->boxes,
      "For codecs that code against bounding boxes, which none of ours does yet: a matrix file whose rows "
      "and columns have the boxes that the .vmat file was encoded with, in the order of the .vmat file");
  verb.example("vismat decode city32.vmat -o city32.mtx");
  verb.runs([options] { run_decode(*options); });
}

}  // namespace vismat::cli
