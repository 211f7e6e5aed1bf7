#include "matrix/files/dataset_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/binsparse.h"
#include "matrix/files/gzip.h"
#include "matrix/files/hdf5_file.h"
#include "matrix/files/matrix_market.h"
#include "matrix/files/npy.h"
#include "matrix/files/npz.h"
#include "matrix/files/text.h"

namespace vismat {
namespace {

constexpr const char* readable =
    "a matrix is read from Binsparse on HDF5 (.bsp.h5, .h5, .hdf5), Matrix Market (.mtx), NumPy (.npy) or "
    "SciPy "
    "(.npz), and from all but HDF5 also gzipped (.gz)";
constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// FILE:PART is cut where FILE is there; a file whose own name has a colon comes first.
std::pair<std::filesystem::path, std::string> file_and_part(const std::filesystem::path& name) {
  std::error_code ignored;
  const std::string& whole = name.native();
  if (std::filesystem::exists(name, ignored)) return {name, ""};
  for (std::size_t colon = whole.rfind(':'); colon != std::string::npos && colon > 0;
       colon = whole.rfind(':', colon - 1)) {
    const std::filesystem::path file = whole.substr(0, colon);
    if (std::filesystem::exists(file, ignored)) return {file, whole.substr(colon + 1)};
  }
  return {name, ""};
}

[[noreturn]] void refuse_unknown(std::string_view bytes) {
  using namespace std::string_view_literals;
  const auto packed = [](const char* with, const char* by) {
    throw FormatError(std::string("is packed with ") + with + "; unpack it with " + by + " first");
  };
  if (bytes.starts_with("\x89VMAT"))
    throw FormatError("is a compressed matrix (.vmat); 'vismat decode' restores it");
  if (bytes.starts_with("\xfd"
                        "7zXZ\0"sv))
    packed("xz", "unxz");
  if (bytes.starts_with("BZh")) packed("bzip2", "bunzip2");
  if (bytes.starts_with("\x28\xb5\x2f\xfd")) packed("zstd", "unzstd");
  if (is_gzip(std::as_bytes(std::span(bytes)))) packed("gzip twice", "gunzip");
  throw FormatError(std::string(bytes.empty() ? "is empty" : "is no matrix file") + "; " + readable +
                    "; Matrix Market begins with '%%MatrixMarket'");
}

std::uint32_t columns_of(const std::string& part) {
  std::uint32_t columns = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), columns);
  if (error != std::errc{} || end != part.data() + part.size())
    throw FormatError("FILE.npy:COLUMNS needs the number of columns that the packed bits of a row stand for");
  return columns;
}

Dataset read_bytes(const MatrixFile& file, MatrixNotes* notes) {
  const std::string_view bytes = text_of(file.bytes);
  if (is_npy(file.bytes)) {
    Dataset dataset;
    dataset.matrix =
        file.part.empty() ? read_npy(file.bytes) : read_packed_npy(file.bytes, columns_of(file.part));
    return dataset;
  }
  if (!file.part.empty())
    throw FormatError(
        "has no parts; FILE:PART is for groups of HDF5 files and for packed bits in .npy files");
  if (is_npz(file.bytes)) {
    Dataset dataset;
    dataset.matrix = read_npz(file.bytes, most_unpacked(file.bytes.size()), notes);
    return dataset;
  }
  if (bytes.starts_with(hdf5_signature)) {
    throw FormatError(file.gzipped ? "is a gzipped HDF5 file; unpack it with gunzip first"
                                   : "is not a regular file; HDF5 needs one");
  }
  std::string room;
  const std::string_view text = as_utf8(file.bytes, room);
  if (!is_matrix_market(text)) refuse_unknown(bytes);
  return read_matrix_market(text, notes);
}

template <typename Write>
void write_stream(const std::filesystem::path& path, const Write& write) {
  AtomicFile file(path);
  AtomicFileStream out(file);
  write(out);
  out.flush();
  file.commit();
}

// FILE of FILE.npy:COLUMNS; nothing for other names.
std::optional<std::filesystem::path> packed_npy(const std::filesystem::path& name, std::uint32_t columns) {
  const std::filesystem::path file = matrix_file_of(name);
  if (file == name) return std::nullopt;
  if (name.native().substr(file.native().size() + 1) != std::to_string(columns)) {
    throw std::invalid_argument(name.string() + ": the matrix has " + std::to_string(columns) +
                                " columns; FILE.npy:" + std::to_string(columns) +
                                " writes them as packed bits");
  }
  return file;
}

}  // namespace

std::filesystem::path MatrixFile::name() const {
  return part.empty() ? path : std::filesystem::path(path.native() + ":" + part);
}

MatrixFile open_matrix_file(const std::filesystem::path& name) {
  MatrixFile file;
  std::tie(file.path, file.part) = file_and_part(name);
  file.is_hdf5 = is_hdf5(file.path);
  if (file.is_hdf5) return file;
  file.bytes = read_file(file.path);
  file.gzipped = is_gzip(file.bytes);
  if (file.gzipped)
    file.bytes = naming(file.path, [&] { return gunzip(file.bytes, most_unpacked(file.bytes.size())); });
  return file;
}

std::string_view format_of(const MatrixFile& file) {
  if (file.is_hdf5) return "Binsparse on HDF5";
  if (is_npy(file.bytes)) return "NumPy array";
  if (is_npz(file.bytes)) return "SciPy or NumPy archive";
  std::string room;
  return naming(file.path,
                [&] { return is_matrix_market(as_utf8(file.bytes, room)) ? "Matrix Market" : ""; });
}

Dataset read_dataset(const MatrixFile& file, MatrixNotes* notes) {
  return naming(file.name(), [&] {
    return file.is_hdf5 ? read_binsparse(Hdf5File::open(file.path, file.part), notes)
                        : read_bytes(file, notes);
  });
}

Dataset read_dataset(const std::filesystem::path& name, MatrixNotes* notes) {
  return read_dataset(open_matrix_file(name), notes);
}

std::filesystem::path matrix_file_of(const std::filesystem::path& name) {
  const std::size_t colon = name.native().rfind(".npy:");
  return colon == std::string::npos ? name : std::filesystem::path(name.native().substr(0, colon + 4));
}

void check_matrix_name(const std::filesystem::path& path) {
  const std::string name = matrix_file_of(path).filename().string();
  constexpr std::array endings = {".h5", ".hdf5", ".mtx", ".npy", ".npz"};
  if (!std::ranges::any_of(endings, [&](const char* ending) { return name.ends_with(ending); })) {
    throw std::invalid_argument(path.string() +
                                ": a matrix is written as .bsp.h5, .h5, .hdf5, .mtx, .npy or .npz");
  }
}

void write_dataset(const std::filesystem::path& path, const Dataset& dataset) {
  check_matrix_name(path);
  const std::string name = path.filename().string();
  if (const auto file = packed_npy(path, dataset.matrix.shape().columns)) {
    return write_stream(*file, [&](std::ostream& out) { write_packed_npy(out, dataset.matrix); });
  }
  if (name.ends_with(".mtx")) {
    return write_stream(path, [&](std::ostream& out) { write_matrix_market(out, dataset); });
  }
  if (name.ends_with(".npy")) {
    return write_stream(path, [&](std::ostream& out) { write_npy(out, dataset.matrix); });
  }
  if (name.ends_with(".npz")) return write_file(path, npz_of(dataset.matrix));
  try {
    check_source_map(dataset.source, dataset.matrix.shape());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path.string() + ": would not be read again: " + error.what());
  }
  write_hdf5(path, [&](Hdf5File& file) { write_binsparse(file, dataset); });
}

bool keeps_everything(const std::filesystem::path& path) {
  return path.extension() == ".h5" || path.extension() == ".hdf5";
}

std::string left_out_in(const std::filesystem::path& path, const Dataset& dataset) {
  const std::string name = path.filename().string();
  const bool bare = name.ends_with(".npz") || name.find(".npy") != std::string::npos;
  std::string left_out;
  const auto say = [&](bool there, const char* what) {
    if (there) left_out += (left_out.empty() ? "" : ", ") + std::string(what);
  };
  const SourceMap& source = dataset.source;
  if (!keeps_everything(path)) {
    say(!dataset.row_bounds.empty() || !dataset.column_bounds.empty(), "boxes");
    say(dataset.row_neighbours.has_value(), "neighbours");
    say(!dataset.sight_lines.empty(), "sight lines");
    say(!dataset.degree_of_visibility.empty(), "degrees of visibility");
    say(!source.boundaries.empty(), "boundaries");
    say(source.row_order || source.column_order, "orders");
    say(source.row_groups || source.column_groups, "groups");
    say(source.tree || source.row_tree, "trees");
    say(!source.row_names.empty() || !source.column_names.empty(), "names");
    say(!source.column_levels.empty(), "levels");
  }
  if (bare) {
    say(!dataset.provenance.empty(), "provenance");
    say(dataset.guarantee != Guarantee::unknown, "guarantee");
    say(dataset.seed.has_value(), "seed");
  }
  return left_out;
}

}  // namespace vismat
