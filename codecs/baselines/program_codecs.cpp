#include "codecs/baselines/program_codecs.h"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "codecs/baselines/whole_file_codec.h"
#include "codecs/rows/bitmap.h"
#include "matrix/base/atomic_file.h"

extern "C" char** environ;

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "vismat-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw std::system_error(errno, std::generic_category(), "cannot make a folder " + name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

constexpr const char* messages = "messages";

class FileActions {
 public:
  explicit FileActions(const ScratchFolder& folder) {
    if (posix_spawn_file_actions_init(&actions_) != 0) throw std::bad_alloc();
    const bool failed =
        posix_spawn_file_actions_addchdir_np(&actions_, folder.path().c_str()) != 0 ||
        posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0) != 0 ||
        posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0) != 0 ||
        posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, messages, O_WRONLY | O_CREAT | O_TRUNC,
                                         0600) != 0;
    if (failed) throw std::bad_alloc();
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// Runs argv[0], found on PATH, in the folder. Returns its error message; empty if it succeeded.
template <std::size_t n>
std::string complaint_of(const ScratchFolder& folder, const char* package, const char* const (&argv)[n]) {
  std::array<char*, n + 1> arguments{};
  std::transform(argv, argv + n, arguments.begin(), [](const char* a) { return const_cast<char*>(a); });
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, argv[0], FileActions(folder).get(), nullptr, arguments.data(), environ);
  if (failed == ENOENT)
    throw std::runtime_error(std::string(argv[0]) + " is not installed (Debian package " + package + ")");
  if (failed != 0)
    throw std::system_error(failed, std::generic_category(), std::string("cannot run ") + argv[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "cannot wait for a program");
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  const auto said = read_file(folder / messages);
  std::string text(reinterpret_cast<const char*>(said.data()), said.size());
  text = text.substr(0, text.find_last_not_of('\n') + 1);
  text = text.substr(text.find_last_of('\n') + 1);  // its last line
  return std::string(argv[0]) + " failed" + (text.empty() ? "" : ": " + text);
}

std::vector<std::byte> encoded_or_throw(const std::string& complaint, const std::filesystem::path& file) {
  if (!complaint.empty()) throw std::runtime_error(complaint);
  return read_file(file);
}

std::vector<std::byte> decoded_or_refuse(const std::string& complaint, const std::filesystem::path& file) {
  if (!complaint.empty()) throw FormatError(complaint);
  if (!std::filesystem::is_regular_file(file)) throw FormatError("holds no " + file.filename().string());
  return read_file(file);
}

// --- zpaq -method 5. One thread and one date, since its bytes depend on both.

constexpr const char* zpaq_package = "zpaq";

Encoded zpaq_encode(const VisibilityMatrix& matrix) {
  const ScratchFolder folder;
  write_file(folder / "bitmap", bitmap_bytes(matrix));
  const std::chrono::sys_seconds date = std::chrono::sys_days(std::chrono::year(2000) / 1 / 1);
  std::filesystem::last_write_time(folder / "bitmap", std::chrono::file_clock::from_sys(date));
  const std::string complaint = complaint_of(folder, zpaq_package,
                                             {"zpaq", "add", "a.zpaq", "bitmap", "-method", "5", "-threads",
                                              "1", "-noattributes", "-until", "20000101000000"});
  return {encoded_or_throw(complaint, folder / "a.zpaq"), {}};
}

VisibilityMatrix zpaq_decode(Bytes payload, Shape shape) {
  const ScratchFolder folder;
  write_file(folder / "a.zpaq", payload);
  const std::string complaint = complaint_of(
      folder, zpaq_package, {"zpaq", "extract", "a.zpaq", "bitmap", "-to", "decoded", "-threads", "1"});
  return matrix_from_bitmap(decoded_or_refuse(complaint, folder / "decoded"), shape);
}

// --- JBIG1, in one resolution layer. A PBM file: "P4", width and height as text, then rows of bits padded to bytes, the
// first column in the highest bit.

constexpr const char* jbig_package = "jbigkit-bin";

void reverse_bits(std::span<std::byte> bytes) {
  for (std::byte& byte : bytes) {
    auto b = std::to_integer<unsigned>(byte);
    b = (b & 0xf0) >> 4 | (b & 0x0f) << 4;
    b = (b & 0xcc) >> 2 | (b & 0x33) << 2;
    b = (b & 0xaa) >> 1 | (b & 0x55) << 1;
    byte = static_cast<std::byte>(b);
  }
}

// An image must have pixels, so a matrix without entries is an empty payload.
bool has_entries(Shape shape) {
  return shape.rows > 0 && shape.columns > 0;
}

Encoded jbig1_encode(const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  if (!has_entries(shape)) return {};
  const std::string head = "P4\n" + std::to_string(shape.columns) + " " + std::to_string(shape.rows) + "\n";
  const auto head_bytes = std::as_bytes(std::span(head));
  auto image = bitmap_bytes(matrix);
  reverse_bits(image);
  image.insert(image.begin(), head_bytes.begin(), head_bytes.end());
  const ScratchFolder folder;
  write_file(folder / "image.pbm", image);
  const std::string complaint =
      complaint_of(folder, jbig_package, {"pbmtojbg", "-q", "image.pbm", "image.jbg"});
  return {encoded_or_throw(complaint, folder / "image.jbg"), {}};
}

// Where the pixels begin. FormatError unless the head is this shape's.
std::size_t head_of_pbm(Bytes image, Shape shape) {
  const auto* at = reinterpret_cast<const char*>(image.data());
  const char* const end = at + image.size();
  const auto number = [&] {
    while (at != end && (*at == ' ' || *at == '\n')) ++at;
    std::uint32_t value = 0;
    at = std::from_chars(at, end, value).ptr;
    return value;
  };
  if (image.size() >= 2 && at[0] == 'P' && at[1] == '4') {
    at += 2;
    const std::uint32_t width = number(), height = number();
    if (Shape{height, width} == shape && at != end)
      return static_cast<std::size_t>(at + 1 - reinterpret_cast<const char*>(image.data()));
  }
  throw FormatError("jbig1: no image of " + std::to_string(shape.columns) + " x " +
                    std::to_string(shape.rows));
}

VisibilityMatrix jbig1_decode(Bytes payload, Shape shape) {
  if (!has_entries(shape)) {
    if (!payload.empty()) throw FormatError("jbig1: an image of no pixels");
    return VisibilityMatrix(shape);
  }
  const ScratchFolder folder;
  write_file(folder / "image.jbg", payload);
  const std::string complaint = complaint_of(folder, jbig_package, {"jbgtopbm", "image.jbg", "image.pbm"});
  auto image = decoded_or_refuse(complaint, folder / "image.pbm");
  const std::size_t head = head_of_pbm(image, shape);
  reverse_bits(std::span(image).subspan(head));
  return matrix_from_bitmap(std::span(image).subspan(head), shape);
}

constexpr std::array table = {
    whole_file_codec<zpaq_encode, zpaq_decode>("zpaq", "bitmap through zpaq -method 5", Origin::baseline),
    whole_file_codec<jbig1_encode, jbig1_decode>("jbig1", "bitmap as an image through pbmtojbg -q",
                                                 Origin::baseline),
};

bool on_path(const std::string& program) {
  const char* const path = ::getenv("PATH");
  std::string_view folders = path == nullptr ? "" : path;
  while (!folders.empty()) {
    const std::size_t end = std::min(folders.find(':'), folders.size());
    if (::access((std::string(folders.substr(0, end)) + "/" + program).c_str(), X_OK) == 0) return true;
    folders.remove_prefix(std::min(end + 1, folders.size()));
  }
  return false;
}

// The programs that each codec of the table runs.
const std::array<std::vector<std::string>, table.size()> programs = {{{"zpaq"}, {"pbmtojbg", "jbgtopbm"}}};

}  // namespace

std::span<const Codec> program_codecs() {
  return table;
}

std::vector<Codec> available_program_codecs() {
  std::vector<Codec> available;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (std::ranges::all_of(programs[i], on_path)) available.push_back(table[i]);
  }
  return available;
}

}  // namespace vismat
