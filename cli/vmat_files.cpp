#include "cli/vmat_files.h"
#include "matrix/files/dataset_file.h"

#include <array>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/vmat/vmat3.h"
#include "matrix/base/atomic_file.h"

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

bool is_vmat(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, vmat::magic.size()> begin = {};
  file.read(begin.data(), begin.size());
  return vmat::begins_vmat(std::as_bytes(std::span(begin)));
}

}  // namespace

std::string facts_of(const Dataset& data) {
  std::string facts = "rows_are: " + data.rows_are + "\ncolumns_are: " + data.columns_are + "\n";
  facts += "guarantee: " + std::string(to_string(data.guarantee)) + "\n";
  if (data.seed) facts += "seed: " + std::to_string(*data.seed) + "\n";
  if (!data.provenance.empty()) facts += "provenance: " + data.provenance + "\n";
  return facts;
}

void with_container(const std::filesystem::path& path, const std::function<void(const Container&)>& work) {
  const auto bytes = read_file(path);
  naming(path, [&] { work(read_container(bytes)); });
}

Dataset read_vmat(const std::filesystem::path& path, const Side& boxes) {
  const auto bytes = read_file(path);
  return naming(path, [&] { return dataset_of(read_container(bytes), boxes); });
}

Dataset read_vmat_of_any_version(const std::filesystem::path& path, const Side& boxes) {
  const auto bytes = read_file(path);
  return naming(path, [&] {
    return dataset_of(is_vmat3(bytes) ? read_vmat3(bytes, all_codecs()) : read_container(bytes), boxes);
  });
}

Dataset read_any_matrix(const std::filesystem::path& path) {
  return is_vmat(path) ? read_vmat(path) : read_dataset(path);
}

}  // namespace vismat::cli
