#include "cli/vmat_files.h"

#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "cli/summary.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/vmat/vmat3.h"

namespace vismat::cli {
namespace {

void read_facts(const std::string& facts, Dataset& data) {
  std::istringstream lines(facts);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) throw FormatError("facts: a line without ': '");
    const std::string key = line.substr(0, colon), value = line.substr(colon + 2);
    if (key == "rows_are") data.rows_are = value;
    if (key == "columns_are") data.columns_are = value;
    if (key == "provenance") data.provenance = value;
    try {
      if (key == "guarantee") data.guarantee = guarantee_from_string(value);
      if (key == "seed") data.seed = std::stoull(value);
    } catch (const std::logic_error& error) {
      throw FormatError("facts: " + key + ": " + error.what());
    }
  }
}

Dataset dataset_of(Container container, const Side& boxes) {
  const std::vector<Codec> codecs = all_codecs();
  const Codec& codec = codec_of_file(container.codec, codecs);
  Dataset data;
  read_facts(container.facts, data);
  data.matrix = decompress(container, codec, boxes);
  data.source = std::move(container.source);
  drop_tree_over_lists(data.source, data.matrix.shape());
  return data;
}

}  // namespace

std::vector<std::byte> bytes_of_vmat(const std::filesystem::path& path) {
  MatrixFile file = open_matrix_file(path);
  if (const std::string_view format = format_of(file); !format.empty()) {
    throw FormatError(path.string() + ": is no .vmat file, but a matrix, " + std::string(format) +
                      "; 'vismat encode' makes a .vmat file of it");
  }
  return std::move(file.bytes);
}

std::string facts_of(const Dataset& data) {
  std::string facts = "rows_are: " + data.rows_are + "\ncolumns_are: " + data.columns_are + "\n";
  facts += "guarantee: " + std::string(to_string(data.guarantee)) + "\n";
  if (data.seed) facts += "seed: " + std::to_string(*data.seed) + "\n";
  if (!data.provenance.empty()) facts += "provenance: " + data.provenance + "\n";
  return facts;
}

void with_container(const std::filesystem::path& path, const std::function<void(const Container&)>& work) {
  const auto bytes = bytes_of_vmat(path);
  naming(path, [&] { work(read_container(bytes)); });
}

Dataset read_vmat(const std::filesystem::path& path, const Side& boxes) {
  const auto bytes = bytes_of_vmat(path);
  return naming(path, [&] { return dataset_of(read_container(bytes), boxes); });
}

Dataset read_vmat_of_any_version(const std::filesystem::path& path, const Side& boxes) {
  const auto bytes = bytes_of_vmat(path);
  return naming(path, [&] {
    return dataset_of(is_vmat3(bytes) ? read_vmat3(bytes, all_codecs()) : read_container(bytes), boxes);
  });
}

Dataset read_matrix(const std::filesystem::path& name) {
  return read_matrix(open_matrix_file(name));
}

Dataset read_matrix(const MatrixFile& file) {
  MatrixNotes notes;
  Dataset data = read_dataset(file, &notes);
  if (const std::string text = notes.text(); !text.empty())
    std::printf("%s: %s\n", printable(file.name().string()).c_str(), text.c_str());
  return data;
}

void write_matrix(const std::filesystem::path& path, const Dataset& data) {
  write_dataset(path, data);
  if (const std::string left_out = left_out_in(path, data); !left_out.empty())
    std::printf("%s: without %s\n", printable(path.string()).c_str(), left_out.c_str());
}

Dataset read_any_matrix(const std::filesystem::path& name) {
  const MatrixFile file = open_matrix_file(name);
  if (!vmat::begins_vmat(file.bytes)) return read_matrix(file);
  return naming(file.name(), [&] { return dataset_of(read_container(file.bytes), {}); });
}

}  // namespace vismat::cli
