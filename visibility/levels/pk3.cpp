#include "visibility/levels/pk3.h"

#include <zip.h>

#include <algorithm>
#include <stdexcept>

#include "matrix/base/byte_reader.h"
#include "visibility/levels/ascii.h"

namespace vismat {
namespace {

std::string reason(zip_error_t& error) {
  const bool no_directory = zip_error_code_zip(&error) == ZIP_ER_NOZIP;
  const std::string text = no_directory ? "no zip archive, or cut short: the directory at its end is missing"
                                        : zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

char folded(char c) {
  return c == '\\' ? '/' : ascii_lower(c);
}

bool ends_in(const std::string& name, std::string_view ending) {
  return name.size() > ending.size() && std::equal(ending.rbegin(), ending.rend(), name.rbegin(),
                                                   [](char a, char b) { return a == folded(b); });
}

}  // namespace

struct Pk3::Archive {
  zip_t* zip;
  explicit Archive(zip_t* opened) : zip(opened) {}
  ~Archive() { zip_discard(zip); }
};

Pk3::Pk3(const std::filesystem::path& path) {
  int code = 0;
  zip_t* zip = zip_open(path.c_str(), ZIP_RDONLY, &code);
  if (zip == nullptr) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    throw std::runtime_error(path.string() + ": cannot open as .pk3: " + reason(error));
  }
  archive_ = std::make_shared<Archive>(zip);
}

Pk3::Pk3(std::span<const std::byte> bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  zip_t* zip = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error);
  const std::string text = reason(error);
  if (zip == nullptr) {
    if (source != nullptr) zip_source_free(source);
    throw FormatError("cannot open as .pk3: " + text);
  }
  archive_ = std::make_shared<Archive>(zip);
}

std::vector<Pk3::Map> Pk3::members(std::string_view ending) const {
  std::vector<Map> found;
  const zip_int64_t members = zip_get_num_entries(archive_->zip, 0);
  for (zip_int64_t i = 0; i < members; ++i) {
    zip_stat_t status;
    if (zip_stat_index(archive_->zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW, &status) != 0) continue;
    if (ends_in(status.name, ending)) found.push_back({status.name, status.size});
  }
  return found;
}

std::vector<Pk3::Map> Pk3::maps() const {
  return members(".bsp");
}

std::vector<Pk3::Map> Pk3::wads() const {
  return members(".wad");
}

std::vector<std::string> Pk3::scripts() const {
  std::vector<std::string> names;
  for (Map& script : members(".shader")) names.push_back(std::move(script.name));
  return names;
}

std::int64_t Pk3::find(const std::string& member) const {
  if (const zip_int64_t exact = zip_name_locate(archive_->zip, member.c_str(), ZIP_FL_ENC_RAW); exact >= 0) {
    return exact;
  }
  std::int64_t found = -1;
  std::string first;
  const zip_int64_t members = zip_get_num_entries(archive_->zip, 0);
  for (zip_int64_t i = 0; i < members; ++i) {
    const char* raw = zip_get_name(archive_->zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW);
    if (raw == nullptr) continue;
    const std::string name = raw;
    if (!std::equal(name.begin(), name.end(), member.begin(), member.end(),
                    [](char a, char b) { return folded(a) == folded(b); })) {
      continue;
    }
    if (found >= 0) {
      throw FormatError("'" + member + "' may be '" + first + "' or '" + name +
                        "'; write its name exactly as in the archive");
    }
    found = i;
    first = name;
  }
  return found;
}

bool Pk3::has(const std::string& member) const {
  return find(member) >= 0;
}

std::vector<std::byte> Pk3::read(const std::string& member) const {
  const std::int64_t index = find(member);
  if (index < 0) {
    auto there = maps();
    const auto with_maps = wads();
    there.insert(there.end(), with_maps.begin(), with_maps.end());
    std::string message = "no member '" + member + "'; its levels are";
    for (std::size_t i = 0; i < std::min<std::size_t>(there.size(), 5); ++i) {
      message += (i == 0 ? " " : ", ") + there[i].name;
    }
    if (there.size() > 5) message += " and " + std::to_string(there.size() - 5) + " more";
    throw FormatError(message + (there.empty() ? " none" : ""));
  }
  zip_stat_t status;
  zip_stat_init(&status);
  zip_stat_index(archive_->zip, static_cast<zip_uint64_t>(index), 0, &status);
  if ((status.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && status.encryption_method != ZIP_EM_NONE) {
    throw FormatError("member '" + member + "' is encrypted; unpack it with its password, and name the file");
  }
  if (status.size > most_member_bytes) {
    throw FormatError("member '" + member + "' claims " + std::to_string(status.size) + " bytes; at most " +
                      std::to_string(most_member_bytes) + " are read");
  }
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
      zip_fopen_index(archive_->zip, static_cast<zip_uint64_t>(index), 0), zip_fclose);
  if (!file) throw FormatError("member '" + member + "': " + zip_strerror(archive_->zip));
  std::vector<std::byte> bytes;  // grows by what really comes out
  constexpr std::size_t step = 1 << 20;
  for (;;) {
    const std::size_t have = bytes.size();
    bytes.resize(have + step);
    const zip_int64_t got = zip_fread(file.get(), bytes.data() + have, step);
    if (got < 0) throw FormatError("member '" + member + "': " + zip_file_strerror(file.get()));
    bytes.resize(have + static_cast<std::size_t>(got));
    if (got == 0) return bytes;
    if (bytes.size() > most_member_bytes) {
      throw FormatError("member '" + member + "' claims " + std::to_string(status.size) +
                        " bytes but unpacks to more than " + std::to_string(most_member_bytes));
    }
  }
}

}  // namespace vismat
