#include "matrix/base/scratch_ids.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismat {
namespace {

[[noreturn]] void fail(const std::filesystem::path& folder, const char* what) {
  throw std::runtime_error(folder.string() + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

ScratchIds::ScratchIds(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::string name = (folder_ / ".vismat-scratch-XXXXXX").string();
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) fail(folder_, "no temporary file to be had");
  ::unlink(name.c_str());
}

ScratchIds::~ScratchIds() {
  if (data_ != nullptr) ::munmap(const_cast<std::uint32_t*>(data_), size_ * sizeof *data_);
  if (file_ >= 0) ::close(file_);
}

void ScratchIds::append(std::span<const std::uint32_t> ids) {
  for (auto bytes = std::as_bytes(ids); !bytes.empty();) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(folder_, "cannot write a temporary file");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  size_ += ids.size();
}

void ScratchIds::map() {
  if (size_ == 0) return;
  void* address = ::mmap(nullptr, size_ * sizeof *data_, PROT_READ, MAP_SHARED, file_, 0);
  if (address == MAP_FAILED) fail(folder_, "cannot map a temporary file");
  data_ = static_cast<const std::uint32_t*>(address);
}

void ScratchIds::swap(ScratchIds& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(file_, other.file_);
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
}

}  // namespace vismat
