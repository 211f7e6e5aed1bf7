// Every format of the specification lists entries line by line; a line is a row or, in CSC, DCSC, COOC and DMATC, a
// column. So each format is first turned into line offsets and ids, checked, freed of zeros, and made into a matrix
// whose rows are the lines. Then the matrices of column formats are transposed, and structures that store one triangle
// are joined with their transpose.
#include "matrix/files/binsparse_matrix.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/claimed_shape.h"
#include "matrix/files/entries.h"

namespace vismat {

namespace {
std::string entry(std::uint64_t i, std::uint64_t value) {
  return "entry " + std::to_string(i) + " is " + std::to_string(value);
}
}  // namespace

[[noreturn]] void refuse_array(const std::string& where, const std::string& what) {
  throw FormatError(where + ": " + what);
}

void need_length(const std::string& name, std::uint64_t length, std::uint64_t wanted, const char* why) {
  if (length != wanted) {
    refuse_array(name, "has " + std::to_string(length) + " entries, but " + why + " calls for " +
                           std::to_string(wanted));
  }
}

void check_offsets(const std::vector<std::uint64_t>& offsets, std::uint64_t ids, const std::string& name) {
  if (offsets.front() != 0)
    refuse_array(name, "begins with " + std::to_string(offsets.front()) + " instead of 0");
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    if (offsets[i] < offsets[i - 1]) refuse_array(name, "descends at entry " + std::to_string(i));
  }
  if (offsets.back() != ids) {
    refuse_array(name, "ends with " + std::to_string(offsets.back()) + ", but there are " +
                           std::to_string(ids) + " entries");
  }
}

void check_ids(const std::vector<std::uint64_t>& offsets, const std::vector<std::uint32_t>& ids,
               std::uint32_t bound, const std::string& name, const std::string& line_is,
               const std::string& id_is) {
  for (std::size_t line = 0; line + 1 < offsets.size(); ++line) {
    for (std::uint64_t i = offsets[line]; i < offsets[line + 1]; ++i) {
      if (ids[i] >= bound) {
        refuse_array(name, entry(i, ids[i]) + ", but there are " + std::to_string(bound) + " " + id_is + "s");
      }
      if (i > offsets[line] && ids[i] <= ids[i - 1]) {
        refuse_array(name, entry(i, ids[i]) + " after " + std::to_string(ids[i - 1]) + " in the same " +
                               line_is + " (" + std::to_string(line) + "); there they must ascend");
      }
    }
  }
}

namespace {

using nlohmann::json;

constexpr const char* descriptor_name = "attribute binsparse";

struct Descriptor {
  std::string format;
  std::uint64_t rows = 0, columns = 0;
  std::uint64_t stored = 0;
  bool says_stored = false;  // newer drafts of the specification leave it to the arrays
  bool iso = false, complex = false, fill = false;
  std::string structure;
};

const json& member(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) refuse_array(descriptor_name, std::string("has no key '") + key + "'");
  return *found;
}

std::uint64_t count(const json& value, const char* what) {
  if (!value.is_number_integer() || (!value.is_number_unsigned() && value.get<std::int64_t>() < 0)) {
    refuse_array(descriptor_name, std::string(what) + " must hold non-negative integers");
  }
  return value.get<std::uint64_t>();
}

std::string text(const json& value, const char* what) {
  if (!value.is_string()) refuse_array(descriptor_name, std::string(what) + " must be a string");
  return value.get<std::string>();
}

Descriptor parse_descriptor(const std::string& source) {
  json whole = json::parse(source, nullptr, false);
  if (whole.is_discarded() || !whole.is_object()) refuse_array(descriptor_name, "is not a JSON object");
  const json& binsparse = whole.contains("binsparse") ? whole["binsparse"] : whole;
  if (!binsparse.is_object()) refuse_array(descriptor_name, "its 'binsparse' is not a JSON object");

  if (binsparse.contains("version")) {
    const json& stated = binsparse["version"];  // a string, but some write the number 0.1
    const std::string version = stated.is_string() ? stated.get<std::string>() : stated.dump();
    const std::string major = version.substr(0, version.find('.'));
    if (!(stated.is_string() || stated.is_number()) || (major != "0" && major != "1"))
      refuse_array(descriptor_name, "version is " + stated.dump(-1, ' ', true) + "; 0.x and 1.x are read");
  }
  if (binsparse.contains("custom") || member(binsparse, "format").is_object())
    refuse_array(descriptor_name, "custom formats are not read, only the predefined ones");
  Descriptor descriptor;
  descriptor.format = text(member(binsparse, "format"), "format");
  const json& shape = member(binsparse, "shape");
  if (!shape.is_array() || shape.size() != 2) refuse_array(descriptor_name, "shape must be [rows, columns]");
  descriptor.rows = count(shape[0], "shape");
  descriptor.columns = count(shape[1], "shape");
  descriptor.says_stored = binsparse.contains("number_of_stored_values");
  if (descriptor.says_stored)
    descriptor.stored = count(binsparse["number_of_stored_values"], "number_of_stored_values");

  const json& types = member(binsparse, "data_types");
  if (!types.is_object()) refuse_array(descriptor_name, "data_types must be a JSON object");
  std::string type = text(member(types, "values"), "data_types.values");
  const auto strip = [&](const std::string& modifier) {
    if (!type.starts_with(modifier + "[") || !type.ends_with("]")) return false;
    type = type.substr(modifier.size() + 1, type.size() - modifier.size() - 2);
    return true;
  };
  descriptor.iso = strip("iso");
  descriptor.complex = strip("complex");
  constexpr const char* known[] = {"uint8", "uint16", "uint32",  "uint64",  "int8", "int16",
                                   "int32", "int64",  "float32", "float64", "bint8"};
  if (std::find(std::begin(known), std::end(known), type) == std::end(known)) {
    refuse_array(descriptor_name, "data_types.values is of unknown type " + json(type).dump(-1, ' ', true));
  }
  if (binsparse.contains("fill")) {
    if (!binsparse["fill"].is_boolean()) refuse_array(descriptor_name, "fill must be true or false");
    descriptor.fill = binsparse["fill"].get<bool>();
  }
  if (binsparse.contains("structure")) descriptor.structure = text(binsparse["structure"], "structure");
  return descriptor;
}

// The line numbers of COO (one for each entry) or of DCSR (one for each line that is not empty).
void check_lines(const std::vector<std::uint32_t>& lines, std::uint32_t line_count, bool may_repeat) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] >= line_count) {
      refuse_array("/indices_0", entry(i, lines[i]) + ", but there are only " + std::to_string(line_count));
    }
    if (i > 0 && (may_repeat ? lines[i] < lines[i - 1] : lines[i] <= lines[i - 1])) {
      refuse_array("/indices_0",
                   entry(i, lines[i]) + " after " + std::to_string(lines[i - 1]) + "; they must ascend");
    }
  }
}

VisibilityMatrix read_dense(const Hdf5File& file, const Descriptor& descriptor, Shape lines) {
  const std::uint64_t cells = std::uint64_t{lines.rows} * lines.columns;
  need_length("/values", descriptor.stored, cells, "the shape");
  const std::vector<std::uint8_t> truth = file.read_truth("/values");
  const std::uint64_t step = descriptor.complex ? 2 : 1;
  need_length("/values", truth.size(), descriptor.iso ? step : cells * step, "the shape");
  if (descriptor.iso && std::count(truth.begin(), truth.end(), 1) == 0) return VisibilityMatrix(lines);
  constexpr std::uint64_t most_of_one_value = std::uint64_t{1} << 26;
  if (descriptor.iso && cells > most_of_one_value)
    refuse_array("/values", "claims " + std::to_string(cells) + " visible entries by a single value");
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> ids;
  for (std::uint32_t line = 0; line < lines.rows; ++line) {
    for (std::uint32_t id = 0; id < lines.columns; ++id) {
      const std::uint64_t at = descriptor.iso ? 0 : (std::uint64_t{line} * lines.columns + id) * step;
      if (truth[at] || truth[at + step - 1]) ids.push_back(id);
    }
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(lines, std::move(offsets), std::move(ids));
}

// An entry whose value is zero is none.
void drop_zeros(const Hdf5File& file, const Descriptor& descriptor, std::vector<std::uint64_t>& offsets,
                std::vector<std::uint32_t>& ids) {
  const std::uint64_t step = descriptor.complex ? 2 : 1;
  const std::vector<std::uint8_t> truth = file.read_truth("/values");
  if (descriptor.iso) {
    if (truth.size() != step && !ids.empty()) need_length("/values", truth.size(), step, "an iso type");
    if (std::count(truth.begin(), truth.end(), 1) > 0) return;
    ids.clear();
    offsets.assign(offsets.size(), 0);
    return;
  }
  need_length("/values", truth.size(), descriptor.stored * step, "number_of_stored_values");
  std::uint64_t kept = 0, from = 0;
  for (std::size_t line = 0; line + 1 < offsets.size(); ++line) {
    for (; from < offsets[line + 1]; ++from) {
      if (truth[from * step] || truth[from * step + step - 1]) ids[kept++] = ids[from];
    }
    offsets[line + 1] = kept;
  }
  ids.resize(kept);
}

// The union with the other triangle, which the structure implies.
VisibilityMatrix both_triangles(const VisibilityMatrix& half, const std::string& structure) {
  constexpr const char* known[] = {"symmetric_lower", "symmetric_upper",      "hermitian_lower",
                                   "hermitian_upper", "skew_symmetric_lower", "skew_symmetric_upper"};
  if (std::find(std::begin(known), std::end(known), structure) == std::end(known)) {
    refuse_array(descriptor_name,
                 "structure " + json(structure).dump(-1, ' ', true) + " is not one of the specification's");
  }
  const Shape shape = half.shape();
  if (shape.rows != shape.columns)
    refuse_array(descriptor_name, "structure " + structure + " needs a square matrix");
  const bool lower = structure.ends_with("lower");
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    const auto stored = half.row(r);
    if (!stored.empty() && (lower ? stored.back() > r : stored.front() < r)) {
      refuse_array(descriptor_name, "structure is " + structure + ", but row " + std::to_string(r) +
                                        " has entries in the other triangle");
    }
  }
  return with_transpose(half);
}

// The number of stored values, from the length of the array that has one for each.
std::uint64_t stored_in(const Hdf5File& file, const std::string& array, const Descriptor& descriptor) {
  if (array == "/values") {
    std::uint64_t cells = 0;
    if (__builtin_mul_overflow(descriptor.rows, descriptor.columns, &cells))
      refuse_array(descriptor_name, "shape has more entries than 64 bits can count");
    return cells;
  }
  std::uint64_t stored = 1;
  for (const std::uint64_t n : file.dimensions(array)) {
    if (__builtin_mul_overflow(stored, n, &stored)) refuse_array(array, "is too long");
  }
  return stored;
}

struct Lines {
  std::vector<std::uint64_t> offsets;
  std::vector<std::uint32_t> ids;
};

// The compressed and the coordinate formats, as line offsets and ids.
Lines read_lines(const Hdf5File& file, const Descriptor& descriptor, std::uint32_t line_count,
                 bool coordinates, bool packed) {
  Lines lines;
  std::vector<std::uint32_t> named;  // lines
  if (coordinates || packed) {
    named = file.read<std::uint32_t>("/indices_0");
    if (coordinates) need_length("/indices_0", named.size(), descriptor.stored, "number_of_stored_values");
    check_lines(named, line_count, coordinates);
  }
  if (!coordinates) {
    lines.offsets = file.read<std::uint64_t>("/pointers_to_1");
    need_length("/pointers_to_1", lines.offsets.size(),
                (packed ? named.size() : line_count) + std::uint64_t{1}, packed ? "/indices_0" : "the shape");
    check_offsets(lines.offsets, descriptor.stored, "/pointers_to_1");
  }
  if (coordinates || packed) {
    std::vector<std::uint64_t> spread(std::size_t{line_count} + 1, 0);
    for (std::size_t i = 0; i < named.size(); ++i) {
      spread[named[i] + std::size_t{1}] += coordinates ? 1 : lines.offsets[i + 1] - lines.offsets[i];
    }
    for (std::size_t line = 0; line < line_count; ++line) spread[line + 1] += spread[line];
    lines.offsets = std::move(spread);
  }
  named = {};
  lines.ids = file.read<std::uint32_t>("/indices_1");
  need_length("/indices_1", lines.ids.size(), descriptor.stored, "number_of_stored_values");
  return lines;
}

}  // namespace

VisibilityMatrix read_binsparse_matrix(const Hdf5File& file, const std::string& descriptor_text,
                                       MatrixNotes* notes) {
  Descriptor descriptor = parse_descriptor(descriptor_text);
  const std::string& format = descriptor.format;
  const bool dense = format == "DMAT" || format == "DMATR" || format == "DMATC";
  const bool coordinates = format == "COO" || format == "COOR" || format == "COOC";
  const bool packed = format == "DCSR" || format == "DCSC";
  if (!dense && !coordinates && !packed && format != "CSR" && format != "CSC") {
    const bool vector = format.ends_with("VEC");
    refuse_array(descriptor_name, "format " + json(format).dump(-1, ' ', true) +
                                      (vector ? " is a vector" : " is not known") +
                                      "; need CSR, CSC, DCSR, DCSC, COO, COOR, COOC, DMAT, DMATR or DMATC");
  }
  if (descriptor.fill) {
    const auto truth = file.read_truth("/fill_value");
    if (std::count(truth.begin(), truth.end(), 1) > 0) {
      refuse_array("/fill_value", "is not zero, so that entries which are not listed would be visible");
    }
  }
  const bool by_columns = format.ends_with("C");
  const std::string line_is = by_columns ? "column" : "row", id_is = by_columns ? "row" : "column";
  if (!descriptor.says_stored)
    descriptor.stored = stored_in(file, dense ? "/values" : "/indices_1", descriptor);
  const Shape shape = claimed_shape(descriptor.rows, descriptor.columns, descriptor.stored);
  const Shape lines = by_columns ? Shape{shape.columns, shape.rows} : shape;
  VisibilityMatrix matrix;
  if (dense) {
    matrix = read_dense(file, descriptor, lines);
  } else {
    auto [offsets, ids] = read_lines(file, descriptor, lines.rows, coordinates, packed);
    check_ids(offsets, ids, lines.columns, "/indices_1", line_is, id_is);
    drop_zeros(file, descriptor, offsets, ids);
    matrix = VisibilityMatrix::from_csr(lines, std::move(offsets), std::move(ids));
  }
  if (by_columns) matrix = transpose(matrix);
  MatrixNotes here;
  if (!dense) here.zeros = descriptor.stored - matrix.ones();
  if (!descriptor.structure.empty()) {
    const std::uint64_t half = matrix.ones();
    matrix = both_triangles(matrix, descriptor.structure);
    here.mirrored = matrix.ones() - half;
  }
  if (notes != nullptr) *notes = here;
  return matrix;
}

void write_binsparse_matrix(Hdf5File& file, const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  const json descriptor = {
      {"binsparse",
       {{"version", "0.1.0"},
        {"format", "CSR"},
        {"shape", {shape.rows, shape.columns}},
        {"number_of_stored_values", matrix.ones()},
        {"data_types", {{"pointers_to_1", "uint64"}, {"indices_1", "uint32"}, {"values", "iso[bint8]"}}}}}};
  constexpr std::uint8_t one = 1;
  file.write_attribute("/", "binsparse", descriptor.dump());
  file.write("/pointers_to_1", matrix.offsets(), {matrix.offsets().size()});
  file.write("/indices_1", matrix.ids(), {matrix.ones()});
  file.write("/values", std::span(&one, 1), {1});
}

}  // namespace vismat
