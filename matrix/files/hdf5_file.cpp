// Files are written in this process and read in a child process. HDF5 1.10 follows damaged pointers in its B-trees and
// heaps into crashes and endless loops, and no check from outside can find all of them. So open() forks a child that
// does all reading (Hdf5Reader) and sends the numbers over a socket; if it dies, or exhausts its time or memory, the
// parent throws one clear FormatError. That costs a fork for each file that is opened (2.5 ms of processor time), and
// reading 200 MB of deflated ids takes 8 % longer than in one process. Tried and found worse: validating in a child and
// then reading in the parent, which decompresses everything twice.
#include "matrix/files/hdf5_file.h"

#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/hdf5_id.h"
#include "matrix/files/hdf5_reader.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VISMAT_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VISMAT_SHADOW_MEMORY 1
#endif
#endif

namespace vismat {
namespace {

// Both ways over the socket: a head, then `bytes` of body. A question's body is object, NUL, attribute; an
// answer is any number of `data` frames and one `done` or `error`.
enum class Kind : std::uint32_t {
  open,
  contains,
  groups_with,
  dimensions,
  read,
  string_attribute,
  number_attribute,
  data,
  done,
  error
};
struct Head {
  Kind kind;
  Hdf5Number number;
  std::uint64_t bytes;
};

bool send_all(int socket, const void* bytes, std::size_t count) {
  const char* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t put = ::send(socket, at, count, MSG_NOSIGNAL);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    at += put;
    count -= static_cast<std::size_t>(put);
  }
  return true;
}

bool receive_all(int socket, void* bytes, std::size_t count) {
  char* at = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = ::recv(socket, at, count, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

bool send_frame(int socket, Kind kind, Hdf5Number number, const void* body, std::size_t bytes) {
  const Head head = {kind, number, bytes};
  return send_all(socket, &head, sizeof head) && send_all(socket, body, bytes);
}

// -- the child
// --------------------------------------------------------------------------------------------------

// The child may be killed by anything the library does, but must not print, dump core, or eat the machine.
void confine(std::uint64_t file_bytes) {
  for (int signal = 1; signal < NSIG; ++signal) ::signal(signal, SIG_DFL);
  const int silence = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int descriptor : {0, 1, 2}) ::dup2(silence, descriptor);
  const auto limit = [](auto resource, rlim_t value) {
    rlimit now{};
    ::getrlimit(resource, &now);
    now.rlim_cur = std::min(value, now.rlim_max);
    ::setrlimit(resource, &now);
  };
  limit(RLIMIT_CORE, 0);
  // Seconds; inflating makes some 200 MB in one, so an honest file of this size needs far less.
  limit(RLIMIT_CPU, 5 + file_bytes / 1'000'000);
#ifndef VISMAT_SHADOW_MEMORY
  unsigned long long pages = 0;
  if (std::FILE* statm = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(statm, "%llu", &pages) == 1) {
      limit(RLIMIT_AS, pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (rlim_t{2} << 30));
    }
    std::fclose(statm);
  }
#endif
}

void answer(int socket, const Hdf5Reader& reader, const Head& question, const std::string& object,
            const std::string& attribute) {
  const auto data = [&](const void* body, std::size_t bytes) {
    if (!send_frame(socket, Kind::data, question.number, body, bytes)) ::_exit(0);
  };
  switch (question.kind) {
    case Kind::contains: {
      if (reader.contains(object)) data("", 0);
      break;
    }
    case Kind::groups_with: {
      for (const std::string& group : reader.groups_with(attribute)) data(group.data(), group.size());
      break;
    }
    case Kind::dimensions: {
      const auto dimensions = reader.dimensions(object);
      data(dimensions.data(), dimensions.size() * sizeof(std::uint64_t));
      break;
    }
    case Kind::read: {
      reader.read(
          object, question.number, [&](std::uint64_t count) { data(&count, sizeof count); },
          [&](std::span<const std::byte> numbers) { data(numbers.data(), numbers.size()); });
      break;
    }
    case Kind::string_attribute: {
      if (const auto text = reader.string_attribute(object, attribute)) data(text->data(), text->size());
      break;
    }
    case Kind::number_attribute: {
      if (const auto number = reader.number_attribute(object, attribute)) data(&*number, sizeof *number);
      break;
    }
    default:
      break;
  }
}

[[noreturn]] void serve(int socket, const std::string& path) {
  std::unique_ptr<Hdf5Reader> reader;
  Head question{};
  while (receive_all(socket, &question, sizeof question)) {
    std::string body(question.bytes, '\0');
    if (!receive_all(socket, body.data(), body.size())) break;
    const std::size_t cut = std::min(body.find('\0'), body.size() - 1);
    try {
      if (!reader) reader = std::make_unique<Hdf5Reader>(path);
      answer(socket, *reader, question, body.substr(0, cut), body.substr(cut + 1));
      send_frame(socket, Kind::done, question.number, "", 0);
    } catch (const std::bad_alloc&) {
      const std::string text = body.substr(0, cut) + ": is too large to be read";
      send_frame(socket, Kind::error, question.number, text.data(), text.size());
    } catch (const std::exception& error) {
      const std::string text = error.what();
      send_frame(socket, Kind::error, question.number, text.data(), text.size());
    }
  }
  ::_exit(0);  // without closing the file: the library may be confused by now, and nothing was written
}

}  // namespace

// -- the parent
// -------------------------------------------------------------------------------------------------

struct Hdf5File::Handle {
  hid_t written = -1;  // create()
  pid_t child = -1;    // open()
  int socket = -1;
  std::string group;  // before every path; no slash at its end

  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (written >= 0) H5Fclose(written);
    if (socket >= 0) ::close(socket);
    end_child();
  }

  int end_child() {
    int status = 0;
    if (child > 0) {
      ::kill(child, SIGKILL);
      while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
    }
    child = -1;
    return status;
  }

  [[noreturn]] void fail_dead(const std::string& where) {
    // Let it finish dying of its own signal before it is reaped.
    int status = 0;
    if (child > 0) {
      while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
    }
    child = -1;
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU)) {
      refuse(where, "is damaged: the HDF5 library takes too long to read it");
    }
    refuse(where, "is damaged so badly that the HDF5 library cannot read it");
  }

  // Calls on_data for each data frame of the answer, which it must receive itself: `bytes` of them.
  void ask(Kind kind, Hdf5Number number, const std::string& object, const std::string& attribute,
           const std::function<bool(std::uint64_t bytes)>& on_data) {
    if (socket < 0) refuse(object, "cannot be read from a file that is being written");
    if (child < 0) refuse(object, "cannot be read: the file is damaged");
    const std::string whole = group.empty() || object != "/" ? group + object : group;
    const std::string body = whole + '\0' + attribute;
    if (!send_frame(socket, kind, number, body.data(), body.size())) fail_dead(object);
    for (;;) {
      Head head{};
      if (!receive_all(socket, &head, sizeof head)) fail_dead(object);
      if (head.kind == Kind::done) return;
      if (head.kind == Kind::data) {
        if (!on_data(head.bytes)) fail_dead(object);
        continue;
      }
      std::string text(std::min<std::uint64_t>(head.bytes, 1 << 16), '\0');
      if (head.kind != Kind::error || !receive_all(socket, text.data(), text.size())) fail_dead(object);
      throw FormatError(text);
    }
  }

  template <typename Number>
  std::vector<Number> read(const std::string& name, Hdf5Number number) {
    std::vector<Number> numbers;
    std::optional<std::uint64_t> count;
    std::uint64_t have = 0;
    ask(Kind::read, number, name, "", [&](std::uint64_t bytes) {
      if (!count) {
        count = 0;
        if (bytes != sizeof *count || !receive_all(socket, &*count, sizeof *count)) return false;
        numbers.resize(*count);
        return true;
      }
      const std::uint64_t more = bytes / sizeof(Number);
      if (more > numbers.size() - have) return false;
      have += more;
      return receive_all(socket, numbers.data() + have - more, bytes);
    });
    return numbers;
  }
};

Hdf5File::Hdf5File(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
Hdf5File::Hdf5File(Hdf5File&&) noexcept = default;
Hdf5File& Hdf5File::operator=(Hdf5File&&) noexcept = default;
Hdf5File::~Hdf5File() = default;

Hdf5File Hdf5File::open(const std::filesystem::path& path, const std::string& group) {
  struct stat status {};
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) throw FormatError(std::string("cannot open: ") + std::strerror(errno));
  const bool regular = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  ::close(file);
  if (!regular) throw FormatError("is not a regular file; HDF5 needs one");

  // /dev/stdin means something else in the child.
  std::error_code unresolved;
  std::filesystem::path name = std::filesystem::canonical(path, unresolved);
  if (unresolved) name = path;
  auto handle = std::make_unique<Handle>();
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::runtime_error(std::string("cannot make a socket: ") + std::strerror(errno));
  }
  handle->socket = ends[0];
  handle->child = ::fork();
  if (handle->child == 0) {
    ::close(ends[0]);
    const int socket = ::fcntl(ends[1], F_DUPFD_CLOEXEC, 3);  // out of the way of confine()
    confine(static_cast<std::uint64_t>(status.st_size));
    serve(socket, name.string());
  }
  const int error = errno;
  ::close(ends[1]);
  if (handle->child < 0)
    throw std::runtime_error(std::string("cannot start a reader: ") + std::strerror(error));
  handle->ask(Kind::open, Hdf5Number::u8, "HDF5", "", [](std::uint64_t) { return false; });
  if (!group.empty()) {
    handle->group = group.starts_with('/') ? group : '/' + group;
    handle->group.erase(handle->group.find_last_not_of('/') + 1);
  }
  return Hdf5File(std::move(handle));
}

bool Hdf5File::contains(const std::string& name) const {
  bool found = false;
  handle_->ask(Kind::contains, Hdf5Number::u8, name, "", [&](std::uint64_t) { return found = true; });
  return found;
}

std::vector<std::string> Hdf5File::groups_with(const std::string& attribute) const {
  std::vector<std::string> groups;
  handle_->ask(Kind::groups_with, Hdf5Number::u8, "/", attribute, [&](std::uint64_t bytes) {
    if (bytes > 1 << 20) return false;
    std::string& group = groups.emplace_back(bytes, '\0');
    return receive_all(handle_->socket, group.data(), bytes);
  });
  return groups;
}

std::vector<std::uint64_t> Hdf5File::dimensions(const std::string& name) const {
  std::vector<std::uint64_t> dimensions;
  handle_->ask(Kind::dimensions, Hdf5Number::u8, name, "", [&](std::uint64_t bytes) {
    dimensions.resize(std::min<std::uint64_t>(bytes / sizeof(std::uint64_t), H5S_MAX_RANK));
    return receive_all(handle_->socket, dimensions.data(), dimensions.size() * sizeof(std::uint64_t));
  });
  return dimensions;
}

template <typename Number>
std::vector<Number> Hdf5File::read(const std::string& name) const {
  constexpr Hdf5Number number = std::is_same_v<Number, float>           ? Hdf5Number::f32
                                : std::is_same_v<Number, std::uint64_t> ? Hdf5Number::u64
                                : std::is_same_v<Number, std::uint32_t> ? Hdf5Number::u32
                                                                        : Hdf5Number::u8;
  return handle_->read<Number>(name, number);
}
template std::vector<std::uint8_t> Hdf5File::read(const std::string&) const;
template std::vector<std::uint32_t> Hdf5File::read(const std::string&) const;
template std::vector<std::uint64_t> Hdf5File::read(const std::string&) const;
template std::vector<float> Hdf5File::read(const std::string&) const;

std::vector<std::uint8_t> Hdf5File::read_truth(const std::string& name) const {
  return handle_->read<std::uint8_t>(name, Hdf5Number::truth);
}

std::optional<std::string> Hdf5File::string_attribute(const std::string& object,
                                                      const std::string& name) const {
  std::optional<std::string> value;
  handle_->ask(Kind::string_attribute, Hdf5Number::u8, object, name, [&](std::uint64_t bytes) {
    value.emplace(bytes, '\0');
    return receive_all(handle_->socket, value->data(), bytes);
  });
  return value;
}

std::optional<std::uint64_t> Hdf5File::number_attribute(const std::string& object,
                                                        const std::string& name) const {
  std::optional<std::uint64_t> value;
  handle_->ask(Kind::number_attribute, Hdf5Number::u8, object, name, [&](std::uint64_t bytes) {
    value = 0;
    return bytes == sizeof *value && receive_all(handle_->socket, &*value, bytes);
  });
  return value;
}

// -- writing
// ----------------------------------------------------------------------------------------------------

namespace {

// Tuned on artificial and level matrices: 2^18 numbers a chunk keep a reader's buffer at 1-2 MB.
constexpr hsize_t chunk_entries = 1 << 18;

template <typename Number>
hid_t file_type() {
  if constexpr (std::is_same_v<Number, float>) return H5T_IEEE_F32LE;
  if constexpr (sizeof(Number) == 1) return H5T_STD_U8LE;
  if constexpr (sizeof(Number) == 8) return H5T_STD_U64LE;
  return H5T_STD_U32LE;
}

hid_t need(hid_t id, const std::string& name) {
  if (id < 0) refuse(name, "cannot be written");
  return id;
}

}  // namespace

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  H5dont_atexit();  // which closes again what could not be closed on a full disk, and crashes
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  auto handle = std::make_unique<Handle>();
  const Hdf5Properties access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_file_locking(access, false, true);
  handle->written = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (handle->written < 0) throw FormatError("cannot be created as an HDF5 file");
  return Hdf5File(std::move(handle));
}

template <typename Number>
void Hdf5File::write(const std::string& name, std::span<const Number> values,
                     std::vector<std::uint64_t> dimensions) {
  const std::vector<hsize_t> extent(dimensions.begin(), dimensions.end());
  const Hdf5Properties make_groups = H5Pcreate(H5P_LINK_CREATE), how = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_create_intermediate_group(make_groups, 1);
  H5Pset_obj_track_times(how, false);
  if (values.size() >= 64 && !extent.empty()) {  // below that, compression only adds
    std::vector<hsize_t> chunk = extent;
    const hsize_t row = std::max<hsize_t>(1, values.size() / extent[0]);
    chunk[0] = std::clamp<hsize_t>(chunk_entries / row, 1, extent[0]);
    H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data());
    if (sizeof(Number) > 1) H5Pset_shuffle(how);
    H5Pset_deflate(how, 4);
  }
  const Hdf5Space space =
      need(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), name);
  const Hdf5Dataset dataset = need(
      H5Dcreate2(handle_->written, name.c_str(), file_type<Number>(), space, make_groups, how, H5P_DEFAULT),
      name);
  if (!values.empty() &&
      H5Dwrite(dataset, file_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    refuse(name, "cannot be written; is the disk full?");
  }
}
template void Hdf5File::write(const std::string&, std::span<const std::uint8_t>, std::vector<std::uint64_t>);
template void Hdf5File::write(const std::string&, std::span<const std::uint32_t>, std::vector<std::uint64_t>);
template void Hdf5File::write(const std::string&, std::span<const std::uint64_t>, std::vector<std::uint64_t>);
template void Hdf5File::write(const std::string&, std::span<const float>, std::vector<std::uint64_t>);

namespace {

void write_single(hid_t file, const std::string& object, const std::string& name, hid_t type,
                  const void* value) {
  const std::string where = object + ": attribute " + name;
  const Hdf5Object holder = need(H5Oopen(file, object.c_str(), H5P_DEFAULT), object);
  const Hdf5Space space = need(H5Screate(H5S_SCALAR), where);
  const Hdf5Attribute attribute =
      need(H5Acreate2(holder, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), where);
  if (H5Awrite(attribute, type, value) < 0) refuse(where, "cannot be written");
}

}  // namespace

void Hdf5File::write_attribute(const std::string& object, const std::string& name, const std::string& value) {
  const Hdf5Type type = need(H5Tcopy(H5T_C_S1), name);
  H5Tset_size(type, value.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  write_single(handle_->written, object, name, type, value.c_str());
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, std::uint64_t value) {
  write_single(handle_->written, object, name, H5T_STD_U64LE, &value);
}

void Hdf5File::close() {
  const hid_t written = std::exchange(handle_->written, -1);
  if (written >= 0 && H5Fclose(written) < 0) throw FormatError("cannot be written; is the disk full?");
}

void write_hdf5(const std::filesystem::path& path, const std::function<void(Hdf5File&)>& contents) {
  AtomicFile partial(path, AtomicFile::Written::by_name);
  try {
    Hdf5File file = Hdf5File::create(partial.partial_path());
    contents(file);
    file.close();
  } catch (const FormatError& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
  partial.commit();
}

bool is_hdf5(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::ifstream file(path, std::ios::binary);
  for (std::streamoff at = 0; file; at = at == 0 ? 512 : 2 * at) {
    std::array<char, 8> begin{};
    if (file.seekg(at).read(begin.data(), begin.size()) &&
        std::memcmp(begin.data(), "\x89HDF\r\n\x1a\n", begin.size()) == 0)
      return true;
  }
  return false;
}

}  // namespace vismat
