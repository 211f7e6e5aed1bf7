#include "matrix/files/npz.h"

#include <zip.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/claimed_shape.h"
#include "matrix/files/entries.h"
#include "matrix/files/npy.h"

namespace vismat {
namespace {

[[noreturn]] void refuse_npz(const std::string& what) {
  throw FormatError(".npz: " + what);
}

struct ZipError {
  zip_error_t error;
  ZipError() { zip_error_init(&error); }
  ~ZipError() { zip_error_fini(&error); }
  std::string text() { return zip_error_strerror(&error); }
};

class Archive {
 public:
  Archive(std::span<const std::byte> bytes, std::uint64_t most) : left_(most) {
    ZipError why;
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &why.error);
    if (source == nullptr) throw std::bad_alloc();
    zip_ = zip_open_from_source(source, ZIP_RDONLY, &why.error);
    if (zip_ != nullptr) return;
    zip_source_free(source);
    refuse_npz("cannot be opened as a zip archive: " + why.text());
  }
  ~Archive() { zip_discard(zip_); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  std::vector<std::string> arrays() const {
    std::vector<std::string> names;
    const zip_int64_t members = zip_get_num_entries(zip_, 0);
    for (zip_int64_t i = 0; i < members; ++i) {
      const char* name = zip_get_name(zip_, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW);
      if (name != nullptr && std::string_view(name).ends_with(".npy")) names.emplace_back(name);
    }
    return names;
  }
  bool has(const std::string& name) const { return zip_name_locate(zip_, name.c_str(), ZIP_FL_ENC_RAW) >= 0; }
  std::vector<std::byte> read(const std::string& name) {
    if (!has(name)) refuse_npz("lacks the member " + name);
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
        zip_fopen(zip_, name.c_str(), ZIP_FL_ENC_RAW), zip_fclose);
    if (!file) refuse_npz(name + ": " + zip_strerror(zip_));
    std::vector<std::byte> bytes;  // grows by what really comes out
    for (std::size_t have = 0;;) {
      if (have == bytes.size()) bytes.resize(std::max<std::size_t>(2 * have, 1 << 16));
      const zip_int64_t got = zip_fread(file.get(), bytes.data() + have, bytes.size() - have);
      if (got < 0) refuse_npz(name + ": " + zip_file_strerror(file.get()));
      const auto more = static_cast<std::uint64_t>(got);
      if (more > left_) refuse_npz("its members unpack to far more than a matrix of this size would");
      left_ -= more;
      have += more;
      if (more == 0) {
        bytes.resize(have);
        return bytes;
      }
    }
  }

 private:
  std::uint64_t left_;  // bytes that members may still unpack to
  zip_t* zip_ = nullptr;
};

// An array and the bytes it borrows from.
class Member {
  template <typename Work>
  auto naming(const Work& work) const {
    try {
      return work();
    } catch (const FormatError& error) {
      refuse_npz(name_ + ": " + error.what());
    }
  }

 public:
  Member(Archive& archive, const char* name)
      : name_(std::string(name) + ".npy"),
        bytes_(archive.read(name_)),
        array_(naming([&] { return NpyArray(bytes_); })) {}

  const NpyArray& array() const { return array_; }
  void need_dimensions(std::size_t dimensions) const {
    if (array_.shape().size() != dimensions) {
      refuse_npz(name_ + " has " + std::to_string(array_.shape().size()) + " dimensions, not " +
                 std::to_string(dimensions));
    }
    if (dimensions > 1 && array_.by_columns())
      refuse_npz(name_ + " is in Fortran's order, which SciPy does not write");
  }
  void need_size(std::uint64_t size) const {
    if (array_.size() != size)
      refuse_npz(name_ + " has " + std::to_string(array_.size()) + " items, not " + std::to_string(size));
  }
  void need_integers() const {
    need_dimensions(1);
    if (!array_.holds_integers()) refuse_npz(name_ + " holds no integers");
  }
  std::uint64_t index(std::uint64_t place) const {
    return naming([&] { return array_.index(place); });
  }
  std::uint32_t index_below(std::uint64_t place, std::uint64_t bound) const {
    const std::uint64_t value = index(place);
    if (value >= bound) {
      refuse_npz(name_ + ": item " + std::to_string(place) + " is " + std::to_string(value) +
                 "; it must be below " + std::to_string(bound));
    }
    return static_cast<std::uint32_t>(value);
  }

 private:
  std::string name_;
  std::vector<std::byte> bytes_;
  NpyArray array_;
};

struct Sparse {
  std::uint64_t rows = 0, columns = 0;
  Shape shape;
  std::vector<Entry> entries;
  std::uint64_t zeros = 0;

  void claim(std::uint64_t stored) { shape = claimed_shape(rows, columns, stored); }
  void add(bool visible, std::uint32_t row, std::uint32_t column) {
    if (visible) {
      entries.push_back({row, column});
    } else {
      ++zeros;
    }
  }
};

void add_coordinates(Archive& archive, Sparse& sparse) {
  const Member data(archive, "data"), row(archive, "row"), column(archive, "col");
  const std::uint64_t stored = data.array().size();
  data.need_dimensions(1);
  for (const Member* indices : {&row, &column}) {
    indices->need_integers();
    indices->need_size(stored);
  }
  sparse.claim(stored);
  for (std::uint64_t i = 0; i < stored; ++i) {
    sparse.add(data.array().truth(i), row.index_below(i, sparse.rows), column.index_below(i, sparse.columns));
  }
}

// csr, csc, and bsr, whose entries are dense blocks.
void add_compressed(Archive& archive, Sparse& sparse, std::string_view format) {
  const Member data(archive, "data"), indices(archive, "indices"), starts(archive, "indptr");
  const bool blocks = format == "bsr", by_columns = format == "csc";
  data.need_dimensions(blocks ? 3 : 1);
  const std::uint64_t high = blocks ? data.array().shape()[1] : 1,
                      wide = blocks ? data.array().shape()[2] : 1;
  if (high == 0 || wide == 0 || sparse.rows % high != 0 || sparse.columns % wide != 0)
    refuse_npz("its blocks of " + std::to_string(high) + " x " + std::to_string(wide) +
               " do not fill the matrix");
  const std::uint64_t lines = by_columns ? sparse.columns : sparse.rows / high;
  const std::uint64_t across = by_columns ? sparse.rows : sparse.columns / wide;
  const std::uint64_t stored = data.array().shape()[0];
  indices.need_integers();
  indices.need_size(stored);
  starts.need_integers();
  starts.need_size(lines + 1);
  sparse.claim(data.array().size());
  std::uint64_t at = 0;
  if (starts.index(0) != 0) refuse_npz("indptr.npy does not begin with 0");
  for (std::uint64_t line = 0; line < lines; ++line) {
    const std::uint64_t end = starts.index(line + 1);
    if (end < at || end > stored) {
      refuse_npz("indptr.npy: item " + std::to_string(line + 1) + " is " + std::to_string(end) +
                 "; it must lie between the one before and the " + std::to_string(stored) +
                 " stored entries");
    }
    for (; at < end; ++at) {
      const std::uint32_t id = indices.index_below(at, across);
      for (std::uint64_t place = 0; place < high * wide; ++place) {
        const std::uint64_t row = (by_columns ? id : line * high) + place / wide;
        const std::uint64_t column = (by_columns ? line : id * wide) + place % wide;
        const bool visible = data.array().truth(at * high * wide + place);
        if (visible || !blocks)
          sparse.add(visible, static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column));
      }
    }
  }
}

void add_diagonals(Archive& archive, Sparse& sparse) {
  const Member data(archive, "data"), offsets(archive, "offsets");
  data.need_dimensions(2);
  offsets.need_dimensions(1);
  offsets.need_size(data.array().shape()[0]);
  if (!offsets.array().holds_integers()) refuse_npz("offsets.npy holds no integers");
  sparse.claim(data.array().size());
  const std::uint64_t length = data.array().shape()[1];
  for (std::uint64_t d = 0; d < offsets.array().size(); ++d) {
    const std::int64_t offset = offsets.array().signed_index(d);
    for (std::uint64_t column = 0; column < std::min(length, sparse.columns); ++column) {
      // Item `column` of a diagonal stands in that column; unsigned, a row above the first is beyond the last.
      const std::uint64_t row = column - static_cast<std::uint64_t>(offset);
      if (row < sparse.rows && data.array().truth(d * length + column))
        sparse.add(true, static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column));
    }
  }
}

VisibilityMatrix read_only_array(Archive& archive) {
  const std::vector<std::string> names = archive.arrays();
  if (names.size() != 1) {
    refuse_npz(
        "has " + std::to_string(names.size()) +
        " arrays and no format.npy; need what scipy.sparse.save_npz writes, or one array of 2 dimensions");
  }
  return read_npy(archive.read(names[0]));
}

// -- writing

template <typename Number>
std::string npy_of(const std::string& type, const auto& numbers) {
  std::string bytes = npy_header(type, {numbers.size()});
  bytes.reserve(bytes.size() + numbers.size() * sizeof(Number));
  for (const auto wide : numbers) {
    const auto number = static_cast<Number>(wide);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return bytes;
}

}  // namespace

bool is_npz(std::span<const std::byte> file) {
  if (!std::string_view(reinterpret_cast<const char*>(file.data()), file.size()).starts_with("PK"))
    return false;
  try {
    return !Archive(file, 0).arrays().empty();
  } catch (const FormatError&) {
    return false;
  }
}

VisibilityMatrix read_npz(std::span<const std::byte> file, std::uint64_t most, MatrixNotes* notes) {
  Archive archive(file, most);
  if (!archive.has("format.npy")) return read_only_array(archive);
  const std::string format = Member(archive, "format").array().text();
  const Member shape(archive, "shape");
  shape.need_integers();
  shape.need_size(2);
  Sparse sparse;
  sparse.rows = shape.index(0);
  sparse.columns = shape.index(1);
  if (format == "coo") {
    add_coordinates(archive, sparse);
  } else if (format == "csr" || format == "csc" || format == "bsr") {
    add_compressed(archive, sparse, format);
  } else if (format == "dia") {
    add_diagonals(archive, sparse);
  } else {
    refuse_npz("format.npy names none of csr, csc, coo, bsr and dia");
  }
  MatrixNotes here;
  here.zeros = sparse.zeros;
  VisibilityMatrix matrix = matrix_of_entries(sparse.shape, sparse.entries, here.repeated);
  if (notes != nullptr) *notes = here;
  return matrix;
}

std::vector<std::byte> npz_of(const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  const bool narrow = std::max<std::uint64_t>({matrix.ones(), shape.rows, shape.columns}) <=
                      std::numeric_limits<std::int32_t>::max();
  const auto indices_of = [&](const auto& numbers) {
    return narrow ? npy_of<std::int32_t>("<i4", numbers) : npy_of<std::int64_t>("<i8", numbers);
  };
  const std::string ones(matrix.ones(), 1);
  const std::vector<std::pair<const char*, std::string>> members = {
      {"indices.npy", indices_of(matrix.ids())},
      {"indptr.npy", indices_of(matrix.offsets())},
      {"format.npy", npy_header("|S3", {}) + "csr"},
      {"shape.npy", npy_of<std::int64_t>("<i8", std::vector<std::uint64_t>{shape.rows, shape.columns})},
      {"data.npy", npy_header("|b1", {matrix.ones()}) + ones}};

  ZipError why;
  const auto need = [&](bool good, zip_t* zip) {
    if (!good)
      throw std::runtime_error(std::string(".npz: cannot be made: ") +
                               (zip ? zip_strerror(zip) : why.text()));
  };
  const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> target(
      zip_source_buffer_create(nullptr, 0, 0, &why.error), zip_source_free);
  need(target != nullptr, nullptr);
  zip_t* zip = zip_open_from_source(target.get(), ZIP_TRUNCATE, &why.error);
  need(zip != nullptr, nullptr);
  zip_source_keep(target.get());
  struct Discard {
    zip_t* zip;
    ~Discard() { zip_discard(zip); }
  } guard{zip};
  for (const auto& [name, bytes] : members) {
    zip_source_t* source = zip_source_buffer(zip, bytes.data(), bytes.size(), 0);
    need(source != nullptr, zip);
    const zip_int64_t index = zip_file_add(zip, name, source, 0);
    if (index < 0) zip_source_free(source);
    need(index >= 0, zip);
    constexpr zip_uint16_t midnight = 0, first_of_1980 = 0x21;  // so that the bytes do not depend on the time
    need(zip_file_set_dostime(zip, static_cast<zip_uint64_t>(index), midnight, first_of_1980, 0) == 0, zip);
  }
  need(zip_close(zip) == 0, zip);
  guard.zip = nullptr;
  zip_stat_t status;
  zip_stat_init(&status);
  need(zip_source_stat(target.get(), &status) == 0 && zip_source_open(target.get()) == 0, nullptr);
  std::vector<std::byte> out(status.size);
  const zip_int64_t got = zip_source_read(target.get(), out.data(), out.size());
  zip_source_close(target.get());
  need(got == static_cast<zip_int64_t>(out.size()), nullptr);
  return out;
}

}  // namespace vismat
