#include "programs/output_check.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/files/dataset_file.h"

namespace vismat {
namespace {

bool ends_in(const std::filesystem::path& file, std::initializer_list<std::string_view> endings) {
  const std::string name = file.filename();
  return std::ranges::any_of(endings, [&](std::string_view ending) { return name.ends_with(ending); });
}

void check_ending(const std::filesystem::path& file, Written what, bool device) {
  const auto refuse = [&](const char* why) { throw std::invalid_argument(file.string() + ": " + why); };
  const bool hdf5 = ends_in(file, {".h5", ".hdf5"});
  if (device && (what == Written::scene || (what == Written::matrix && hdf5)))
    refuse("is no regular file, which HDF5 needs");
  if (what == Written::matrix) check_matrix_name(file);
  if (what == Written::scene && !ends_in(file, {".h5"})) refuse("a scene is written as .scene.h5 or .h5");
  if (what == Written::vmat && !device && !ends_in(file, {".vmat"}))
    refuse("a compressed matrix is written as .vmat");
  if (what == Written::text && (hdf5 || ends_in(file, {".mtx", ".vmat"})))
    refuse("is the name of a matrix or scene, but a table or JSON is written there");
}

void check_place(const std::filesystem::path& file, const OutputTarget& target, bool folder, bool made) {
  const auto refuse = [&](int error) {
    throw std::runtime_error(file.string() + ": cannot write there: " + std::strerror(error));
  };
  using Kind = OutputTarget::Kind;
  if (target.kind == Kind::device) {
    if (folder) refuse(ENOTDIR);
    if (target.descriptor < 0 && ::access(target.path.c_str(), W_OK) != 0) refuse(errno);
    return;
  }
  if (folder && target.kind == Kind::file) refuse(ENOTDIR);
  if (!folder && (target.kind == Kind::folder || !target.path.has_filename())) refuse(EISDIR);
  if (target.kind == Kind::file && ::access(target.path.c_str(), W_OK) != 0) refuse(errno);
  const std::filesystem::path parent = target.path.has_parent_path() ? target.path.parent_path() : ".";
  const bool is_there = target.kind != Kind::nothing;
  const std::filesystem::path& written_to = folder && (is_there || !made) ? target.path : parent;
  std::error_code error;
  if (std::filesystem::exists(written_to, error) && !std::filesystem::is_directory(written_to, error))
    refuse(ENOTDIR);
  if (::access(written_to.c_str(), W_OK | X_OK) != 0) refuse(errno);
}

/// Whether both are one file, or will be, by links or by other spellings.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  struct stat of_a {
  }, of_b{};
  const bool a_exists = ::stat(a.c_str(), &of_a) == 0, b_exists = ::stat(b.c_str(), &of_b) == 0;
  if (a_exists != b_exists) return false;
  if (a_exists) return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino && !S_ISCHR(of_a.st_mode);
  std::error_code error;
  const auto whole = [&](const std::filesystem::path& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(output_target(file).path), error);
  };
  return whole(a) == whole(b) && !error;
}

/// The file itself, and FILE of FILE:PART.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& input) {
  std::vector<std::filesystem::path> files = {input};
  const std::string& name = input.native();
  for (std::size_t colon = name.find(':'); colon != std::string::npos; colon = name.find(':', colon + 1))
    files.emplace_back(name.substr(0, colon));
  return files;
}

}  // namespace

void check_outputs(std::span<const std::filesystem::path> inputs, std::span<const OutputName> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [option, name, what] = outputs[i];
    const std::filesystem::path file = what == Written::matrix ? matrix_file_of(name) : name;
    const OutputTarget target = output_target(file);
    const bool made = what == Written::made_folder, folder = what == Written::folder || made;
    // A slip that would lose a file is told first.
    for (const std::filesystem::path& input : inputs) {
      for (const std::filesystem::path& read : files_of(input)) {
        if (!folder && same_file(file, read)) {
          throw std::invalid_argument(option + " " + file.string() + ": is the input " + input.string() +
                                      ", which would be lost; name another file");
        }
      }
    }
    for (const OutputName& other : outputs.first(i)) {
      if (same_file(file, other.path) && !(folder && other.what == Written::folder)) {
        throw std::invalid_argument(option + " " + file.string() + ": " + other.option +
                                    " writes the same file; name another");
      }
    }
    check_ending(file, what, target.kind == OutputTarget::Kind::device);
    check_place(file, target, folder, made);
  }
}

}  // namespace vismat
