// Owns identifiers of the HDF5 library and closes them, and refuses what it cannot read. Private to matrix/files/.
#pragma once
#include <hdf5.h>

#include <string>
#include <utility>

#include "matrix/base/byte_reader.h"

namespace vismat {

/// Throws a FormatError that begins with `where`, a path inside the file.
[[noreturn]] inline void refuse(const std::string& where, const std::string& what) {
  throw FormatError(where + ": " + what);
}

/// An identifier that is closed with this object; negative if the library refused.
template <herr_t (*close)(hid_t)>
class Hdf5Id {
 public:
  Hdf5Id(hid_t id) : id_(id) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Hdf5Id& operator=(Hdf5Id&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Hdf5Id() {
    if (id_ >= 0) close(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
};
using Hdf5Attribute = Hdf5Id<H5Aclose>;
using Hdf5Dataset = Hdf5Id<H5Dclose>;
using Hdf5Object = Hdf5Id<H5Oclose>;
using Hdf5Properties = Hdf5Id<H5Pclose>;
using Hdf5Space = Hdf5Id<H5Sclose>;
using Hdf5Type = Hdf5Id<H5Tclose>;

}  // namespace vismat
