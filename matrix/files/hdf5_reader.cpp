// Asks first and reads later. Whatever the library says about an array (links, dataspace, type, layout, filters,
// chunks) is checked against the bytes that the file really has before a single number is read. Numbers are then read a
// few chunks at a time, so that memory stays small whatever the file claims.
#include "matrix/files/hdf5_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "matrix/base/byte_reader.h"
#include "matrix/files/hdf5_id.h"

namespace vismat {
namespace {

constexpr std::uint64_t deflate_limit = 1032;     // bytes that one deflated byte can make, at most
constexpr std::uint64_t piece_entries = 1 << 18;  // read at a time
constexpr std::uint64_t largest_piece = std::uint64_t{1} << 26;
constexpr std::uint64_t largest_chunk = std::uint64_t{256} << 20;  // bytes; the library holds a whole one
constexpr std::size_t longest_string = 1 << 20;
constexpr std::size_t most_groups = 100;

// Only hard links are followed: soft and external ones may point anywhere.
bool hard_linked(hid_t file, const std::string& name) {
  for (std::size_t end = 1; end < name.size(); ++end) {
    end = std::min(name.find('/', end), name.size());
    const std::string part = name.substr(0, end);
    const htri_t exists = H5Lexists(file, part.c_str(), H5P_DEFAULT);
    if (exists < 0) refuse(part, "its group is damaged or no group at all");
    if (exists == 0) return false;
    H5L_info_t info;
    if (H5Lget_info(file, part.c_str(), &info, H5P_DEFAULT) < 0) refuse(part, "its link is damaged");
    if (info.type != H5L_TYPE_HARD)
      refuse(part, "is a soft or external link; it must be in this file under this name");
  }
  return true;
}

Hdf5Object open_object(hid_t file, const std::string& name) {
  if (!hard_linked(file, name)) refuse(name, "is missing");
  Hdf5Object object = H5Oopen(file, name.c_str(), H5P_DEFAULT);
  if (object < 0) refuse(name, "is damaged");
  return object;
}

std::vector<std::uint64_t> dimensions_of(hid_t space, const std::string& name) {
  const H5S_class_t kind = space < 0 ? H5S_NO_CLASS : H5Sget_simple_extent_type(space);
  if (kind != H5S_SIMPLE && kind != H5S_SCALAR) refuse(name, "has no plain dataspace; need an array");
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || rank > 4) refuse(name, "has " + std::to_string(rank) + " dimensions; at most 4 are read");
  std::array<hsize_t, H5S_MAX_RANK> dimensions{};
  if (H5Sget_simple_extent_dims(space, dimensions.data(), nullptr) < 0)
    refuse(name, "its dataspace is damaged");
  return {dimensions.begin(), dimensions.begin() + rank};
}

struct Number {
  H5T_class_t kind;  // H5T_INTEGER or H5T_FLOAT
  std::size_t bytes;
  bool is_signed;
};

Number number_of(hid_t type, const std::string& name) {
  Hdf5Type base = -1;
  H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
  if (kind == H5T_ENUM) {  // h5py's bool
    base = H5Tget_super(type);
    type = base;
    kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
  }
  if (kind != H5T_INTEGER && kind != H5T_FLOAT)
    refuse(name, "holds neither integers nor floating-point numbers");
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > 8)
    refuse(name, "has numbers of " + std::to_string(bytes) + " bytes; at most 8 are read");
  return {kind, bytes, kind == H5T_INTEGER && H5Tget_sign(type) != H5T_SGN_NONE};
}

struct Layout {
  std::vector<std::uint64_t> dimensions;
  std::uint64_t count = 1;       // numbers in all
  std::uint64_t row = 1;         // numbers for one step of the first dimension
  std::uint64_t chunk_rows = 1;  // of the first dimension
};

std::uint64_t times(std::uint64_t a, std::uint64_t b, const std::string& name) {
  std::uint64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product)) refuse(name, "claims more entries than 64 bits can count");
  return product;
}

// The filters that need the library's less trodden paths (szip, nbit, scaleoffset, plugins) are refused.
bool deflated(hid_t properties, const std::string& name) {
  const int filters = H5Pget_nfilters(properties);
  if (filters < 0 || filters > 8) refuse(name, "its list of filters is damaged");
  bool any = false;
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, values = 0, config = 0;
    std::size_t no_values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &no_values,
                                               &values, 0, nullptr, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32) {
      refuse(name, "uses HDF5 filter " + std::to_string(filter) +
                       "; only deflate, shuffle and fletcher32 are read");
    }
    any = any || filter == H5Z_FILTER_DEFLATE;
  }
  return any;
}

Layout layout_of(hid_t dataset, std::size_t number_bytes, std::uint64_t file_bytes, const std::string& name) {
  Layout layout;
  const Hdf5Space space = H5Dget_space(dataset);
  layout.dimensions = dimensions_of(space, name);
  for (std::size_t i = 0; i < layout.dimensions.size(); ++i) {
    layout.count = times(layout.count, layout.dimensions[i], name);
    if (i > 0) layout.row = times(layout.row, layout.dimensions[i], name);
  }
  const std::uint64_t bytes = times(layout.count, number_bytes, name);
  if (bytes == 0) return layout;

  const Hdf5Properties properties = H5Dget_create_plist(dataset);
  if (properties < 0) refuse(name, "its description is damaged");
  if (H5Pget_external_count(properties) != 0)
    refuse(name, "keeps its data in another file; it must be in this one");
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  const auto need = [&](bool held) {
    if (!held) {
      refuse(name, "claims " + std::to_string(layout.count) + " entries, which the " +
                       std::to_string(stored) + " bytes stored for it in a file of " +
                       std::to_string(file_bytes) + " cannot hold");
    }
  };
  need(stored <= file_bytes);
  const H5D_layout_t kind = H5Pget_layout(properties);
  if (kind == H5D_COMPACT || kind == H5D_CONTIGUOUS) {
    need(bytes <= stored);
    if (kind == H5D_CONTIGUOUS) need(H5Dget_offset(dataset) <= file_bytes - bytes);
    return layout;
  }
  if (kind != H5D_CHUNKED)
    refuse(name, "is virtual or of unknown layout; it must be contiguous, compact or chunked");

  need((deflated(properties, name) ? times(stored, deflate_limit, name) : stored) >= bytes);
  std::array<hsize_t, H5S_MAX_RANK> chunk{};
  const int rank = static_cast<int>(layout.dimensions.size());
  if (rank == 0 || H5Pget_chunk(properties, rank, chunk.data()) != rank)
    refuse(name, "its chunks are damaged");
  std::uint64_t chunk_bytes = number_bytes, chunks_needed = 1;
  for (int i = 0; i < rank; ++i) {
    if (chunk[i] == 0) refuse(name, "has empty chunks");
    chunk_bytes = times(chunk_bytes, chunk[i], name);
    chunks_needed = times(chunks_needed, (layout.dimensions[i] - 1) / chunk[i] + 1, name);
  }
  if (chunk_bytes > largest_chunk) {
    refuse(name, "has chunks of " + std::to_string(chunk_bytes) + " bytes; at most " +
                     std::to_string(largest_chunk) + " are read");
  }
  hsize_t chunks = 0;
  if (H5Dget_num_chunks(dataset, space, &chunks) < 0 || chunks < chunks_needed) {
    refuse(name, "has " + std::to_string(chunks) + " of its " + std::to_string(chunks_needed) + " chunks");
  }
  layout.chunk_rows = std::min<std::uint64_t>(chunk[0], layout.dimensions[0]);
  return layout;
}

template <typename Wanted, typename Wide>
Wanted narrow(Wide value, std::uint64_t entry, const std::string& name) {
  if constexpr (std::is_same_v<Wanted, bool>) {
    return value != 0;
  } else if constexpr (std::is_floating_point_v<Wanted>) {
    const double wide = static_cast<double>(value);
    if (std::isfinite(wide) && std::abs(wide) > std::numeric_limits<Wanted>::max()) {
      refuse(name, "entry " + std::to_string(entry) + " is too large for a 32-bit floating-point number");
    }
  } else {
    if (value < 0 || static_cast<std::uint64_t>(value) > std::numeric_limits<Wanted>::max()) {
      refuse(name, "entry " + std::to_string(entry) + " is " + std::to_string(value) +
                       "; it must lie between 0 and " + std::to_string(std::numeric_limits<Wanted>::max()));
    }
  }
  return static_cast<Wanted>(value);
}

template <typename Wanted, typename Wide>
void narrow_all(std::span<const std::byte> wide, std::uint64_t first, const std::string& name,
                std::vector<std::byte>& out) {
  const std::size_t count = wide.size() / sizeof(Wide);
  out.resize(count * sizeof(Wanted));
  for (std::size_t i = 0; i < count; ++i) {
    Wide value;
    std::memcpy(&value, wide.data() + i * sizeof value, sizeof value);
    const Wanted narrowed = narrow<Wanted>(value, first + i, name);
    std::memcpy(out.data() + i * sizeof narrowed, &narrowed, sizeof narrowed);
  }
}

template <typename Wide>
void convert(std::span<const std::byte> wide, Hdf5Number wanted, std::uint64_t first, const std::string& name,
             std::vector<std::byte>& out) {
  switch (wanted) {
    case Hdf5Number::u8:
      return narrow_all<std::uint8_t, Wide>(wide, first, name, out);
    case Hdf5Number::u32:
      return narrow_all<std::uint32_t, Wide>(wide, first, name, out);
    case Hdf5Number::u64:
      return narrow_all<std::uint64_t, Wide>(wide, first, name, out);
    case Hdf5Number::f32:
      return narrow_all<float, Wide>(wide, first, name, out);
    case Hdf5Number::truth:
      return narrow_all<bool, Wide>(wide, first, name, out);
  }
}

Hdf5Dataset open_dataset(hid_t file, const std::string& name) {
  const Hdf5Object object = open_object(file, name);
  if (H5Iget_type(object) != H5I_DATASET) refuse(name, "is not an array");
  Hdf5Dataset dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  if (dataset < 0) refuse(name, "is damaged");
  return dataset;
}

// Negative if there is none.
Hdf5Attribute open_attribute(hid_t holder, const std::string& name, const std::string& where) {
  const htri_t exists = H5Aexists(holder, name.c_str());
  if (exists < 0) refuse(where, "is damaged");
  if (exists == 0) return -1;
  Hdf5Attribute attribute = H5Aopen(holder, name.c_str(), H5P_DEFAULT);
  const Hdf5Space space = attribute < 0 ? -1 : H5Aget_space(attribute);
  if (space < 0) refuse(where, "is damaged");
  if (H5Sget_simple_extent_npoints(space) != 1) refuse(where, "is not a single value");
  return attribute;
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);
  const Hdf5Properties access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_file_locking(access, false, true);
  // Without chunk cache: pieces cover whole chunks, so none is wanted twice.
  H5Pset_cache(access, 0, 0, 0, 0);
  file_ = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (file_ < 0) throw FormatError("is no HDF5 file, or a damaged one");
  hsize_t bytes = 0;
  if (H5Fget_filesize(file_, &bytes) < 0) throw FormatError("the HDF5 library cannot tell its size");
  file_bytes_ = bytes;
}

Hdf5Reader::~Hdf5Reader() {
  H5Fclose(file_);
}

bool Hdf5Reader::contains(const std::string& name) const {
  return hard_linked(file_, name);
}

std::vector<std::string> Hdf5Reader::groups_with(const std::string& attribute) const {
  std::vector<std::string> found, level = {"/"};
  for (int depth = 0; depth <= 8; ++depth) {
    std::vector<std::string> below;
    for (const std::string& name : level) {
      const Hdf5Object group = H5Oopen(file_, name.c_str(), H5P_DEFAULT);
      if (group < 0 || H5Iget_type(group) != H5I_GROUP) continue;
      if (H5Aexists(group, attribute.c_str()) > 0) found.push_back(name);
      const auto collect = [](hid_t, const char* link, const H5L_info_t* info, void* names) -> herr_t {
        auto& links = *static_cast<std::vector<std::string>*>(names);
        if (info->type == H5L_TYPE_HARD) links.emplace_back(link);
        return links.size() < most_groups ? 0 : 1;
      };
      std::vector<std::string> links;
      H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &links);
      for (const std::string& link : links) {
        if (below.size() < most_groups) below.push_back((name == "/" ? name : name + "/") + link);
      }
    }
    level = std::move(below);
  }
  if (found.size() > most_groups) found.resize(most_groups);
  return found;
}

std::vector<std::uint64_t> Hdf5Reader::dimensions(const std::string& name) const {
  const Hdf5Dataset dataset = open_dataset(file_, name);
  return dimensions_of(Hdf5Space(H5Dget_space(dataset)), name);
}

void Hdf5Reader::read(const std::string& name, Hdf5Number wanted,
                      const std::function<void(std::uint64_t)>& count, const Sink& sink) const {
  const Hdf5Dataset dataset = open_dataset(file_, name);
  const Number stored = number_of(Hdf5Type(H5Dget_type(dataset)), name);
  const bool wants_integer = wanted != Hdf5Number::f32 && wanted != Hdf5Number::truth;
  if (wants_integer && stored.kind == H5T_FLOAT)
    refuse(name, "holds floating-point numbers; it must hold integers");
  const Layout layout = layout_of(dataset, stored.bytes, file_bytes_, name);
  count(layout.count);
  if (layout.count == 0) return;

  const Hdf5Space space = H5Dget_space(dataset);
  const std::uint64_t rows = layout.dimensions.empty() ? 1 : layout.dimensions[0];
  const std::uint64_t chunks = std::max<std::uint64_t>(1, piece_entries / layout.row / layout.chunk_rows);
  const std::uint64_t step = std::min(rows, chunks * layout.chunk_rows);
  if (times(step, layout.row, name) > largest_piece)
    refuse(name, "is cut into chunks too unlike its rows to be read");

  const auto read_rows = [&](std::uint64_t first, std::uint64_t extent, hid_t memory_type, void* numbers) {
    Hdf5Space memory = H5S_ALL;
    if (!layout.dimensions.empty()) {
      std::vector<hsize_t> start(layout.dimensions.size(), 0),
          extents(layout.dimensions.begin(), layout.dimensions.end());
      start[0] = first;
      extents[0] = extent;
      memory = H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
      H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extents.data(), nullptr);
    }
    if (H5Dread(dataset, memory_type, memory, space, H5P_DEFAULT, numbers) < 0)
      refuse(name, "its data are damaged");
  };
  const bool fits = stored.kind == H5T_INTEGER && !stored.is_signed &&
                    ((wanted == Hdf5Number::u32 && stored.bytes <= 4) || wanted == Hdf5Number::u64);
  std::vector<std::byte> in, out;
  for (std::uint64_t row = 0; row < rows; row += step) {
    const std::uint64_t extent = std::min(step, rows - row), entries = extent * layout.row;
    if (fits) {  // the library's own widening cannot lose anything
      const bool narrow_type = wanted == Hdf5Number::u32;
      out.resize(entries * (narrow_type ? 4 : 8));
      read_rows(row, extent, narrow_type ? H5T_NATIVE_UINT32 : H5T_NATIVE_UINT64, out.data());
    } else {
      in.resize(entries * 8);
      if (stored.kind == H5T_FLOAT || wanted == Hdf5Number::f32) {
        read_rows(row, extent, H5T_NATIVE_DOUBLE, in.data());
        convert<double>(in, wanted, row * layout.row, name, out);
      } else if (stored.is_signed) {
        read_rows(row, extent, H5T_NATIVE_INT64, in.data());
        convert<std::int64_t>(in, wanted, row * layout.row, name, out);
      } else {
        read_rows(row, extent, H5T_NATIVE_UINT64, in.data());
        convert<std::uint64_t>(in, wanted, row * layout.row, name, out);
      }
    }
    sink(out);
  }
}

std::optional<std::string> Hdf5Reader::string_attribute(const std::string& object,
                                                        const std::string& name) const {
  const Hdf5Object holder = open_object(file_, object);
  const std::string where = object + ": attribute " + name;
  const Hdf5Attribute attribute = open_attribute(holder, name, where);
  if (attribute < 0) return std::nullopt;
  const Hdf5Type type = H5Aget_type(attribute);
  if (type < 0 || H5Tget_class(type) != H5T_STRING) refuse(where, "is not a string");
  if (H5Tis_variable_str(type) > 0) {
    const Hdf5Type memory = H5Tcopy(H5T_C_S1);
    H5Tset_size(memory, H5T_VARIABLE);
    H5Tset_cset(memory, H5Tget_cset(type));
    char* text = nullptr;
    if (H5Aread(attribute, memory, &text) < 0) refuse(where, "is damaged");
    const std::string value(text == nullptr ? "" : text);
    H5free_memory(text);
    if (value.size() > longest_string) refuse(where, "is longer than a megabyte");
    return value;
  }
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > longest_string)
    refuse(where, "is " + std::to_string(size) + " bytes long; need 1 to 2^20");
  std::string value(size, '\0');
  if (H5Aread(attribute, type, value.data()) < 0) refuse(where, "is damaged");
  value.resize(std::min(size, value.find('\0')));
  if (H5Tget_strpad(type) == H5T_STR_SPACEPAD) value.erase(value.find_last_not_of(' ') + 1);
  return value;
}

std::optional<std::uint64_t> Hdf5Reader::number_attribute(const std::string& object,
                                                          const std::string& name) const {
  const Hdf5Object holder = open_object(file_, object);
  const std::string where = object + ": attribute " + name;
  const Hdf5Attribute attribute = open_attribute(holder, name, where);
  if (attribute < 0) return std::nullopt;
  const Number stored = number_of(Hdf5Type(H5Aget_type(attribute)), where);
  if (stored.kind != H5T_INTEGER) refuse(where, "is not an integer");
  if (stored.is_signed) {
    std::int64_t value = 0;
    if (H5Aread(attribute, H5T_NATIVE_INT64, &value) < 0) refuse(where, "is damaged");
    if (value < 0) refuse(where, "is " + std::to_string(value) + "; it must not be negative");
    return static_cast<std::uint64_t>(value);
  }
  std::uint64_t value = 0;
  if (H5Aread(attribute, H5T_NATIVE_UINT64, &value) < 0) refuse(where, "is damaged");
  return value;
}

}  // namespace vismat
