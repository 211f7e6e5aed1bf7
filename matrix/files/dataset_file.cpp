#include "matrix/files/dataset_file.h"

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/binsparse.h"
#include "matrix/files/hdf5_file.h"
#include "matrix/files/matrix_market.h"

namespace vismat {
namespace {

Dataset read_market_file(const std::filesystem::path& path) {
  const std::vector<std::byte> text = read_file(path);
  constexpr std::string_view mark = "%%MatrixMarket";
  if (!std::string_view(reinterpret_cast<const char*>(text.data()), text.size()).starts_with(mark)) {
    throw FormatError("is neither a Binsparse file (.bsp.h5) nor a Matrix Market file (.mtx)");
  }
  return read_matrix_market(text);
}

}  // namespace

Dataset read_dataset(const std::filesystem::path& path) {
  try {
    return is_hdf5(path) ? read_binsparse(Hdf5File::open(path)) : read_market_file(path);
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

void check_matrix_name(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (!name.ends_with(".h5") && !name.ends_with(".hdf5") && !name.ends_with(".mtx")) {
    throw std::invalid_argument(path.string() + ": a matrix is written as .bsp.h5, .h5, .hdf5 or .mtx");
  }
}

void write_dataset(const std::filesystem::path& path, const Dataset& dataset) {
  check_matrix_name(path);
  if (path.filename().string().ends_with(".mtx")) {
    AtomicFile file(path);
    AtomicFileStream out(file);
    write_matrix_market(out, dataset);
    out.flush();
    return file.commit();
  }
  try {
    check_source_map(dataset.source, dataset.matrix.shape());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path.string() + ": would not be read again: " + error.what());
  }
  write_hdf5(path, [&](Hdf5File& file) { write_binsparse(file, dataset); });
}

}  // namespace vismat
