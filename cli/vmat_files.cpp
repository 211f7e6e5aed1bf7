#include "cli/vmat_files.h"

#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "codecs/baseline_codecs.h"
#include "matrix/atomic_file.h"

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
    if (key == "columns_are_nodes") data.source.columns_are_nodes = value == "yes";
    if (key == "provenance") data.provenance = value;
    try {
      if (key == "guarantee") data.guarantee = guarantee_from_string(value);
      if (key == "seed") data.seed = std::stoull(value);
    } catch (const std::logic_error& error) {
      throw FormatError("facts: " + key + ": " + error.what());
    }
  }
}

Dataset dataset_of(const Container& container) {
  Dataset data;
  read_facts(container.facts, data);
  data.matrix = decompress(container, find_codec(container.codec));
  data.source.tree = container.tree;
  data.source.row_tree = container.row_tree;
  data.source.row_order = container.row_order;
  data.source.column_order = container.column_order;
  data.source.row_groups = container.row_groups;
  data.source.column_groups = container.column_groups;
  data.source.boundaries = container.boundaries;
  if (const std::uint32_t columns = container.shape.columns;
      data.source.tree ? (data.source.columns_are_nodes ? data.source.tree->size() : data.source.tree->object_count()) != columns
                : data.source.columns_are_nodes) {
    throw FormatError("tree section: does not fit the " + std::to_string(columns) + " columns");
  }
  if (data.source.row_tree && data.source.row_tree->object_count() != container.shape.rows)
    throw FormatError("row tree section: does not fit the " + std::to_string(container.shape.rows) + " rows");
  return data;
}

}  // namespace

std::string facts_of(const Dataset& data) {
  std::string facts = "rows_are: " + data.rows_are + "\ncolumns_are: " + data.columns_are + "\n";
  facts += "guarantee: " + std::string(to_string(data.guarantee)) + "\n";
  if (data.source.columns_are_nodes) facts += "columns_are_nodes: yes\n";
  if (data.seed) facts += "seed: " + std::to_string(*data.seed) + "\n";
  if (!data.provenance.empty()) facts += "provenance: " + data.provenance + "\n";
  return facts;
}

void with_container(const std::filesystem::path& path, const std::function<void(const Container&)>& work) {
  const auto bytes = read_file(path);
  try {
    work(read_container(bytes));
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

std::string codec_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  char head[61] = {};  // docs/vmat.md
  file.read(head, 60);
  return head + 28;
}

Dataset read_vmat(const std::filesystem::path& path) {
  Dataset data;
  with_container(path, [&](const Container& container) { data = dataset_of(container); });
  return data;
}

Dataset read_any_matrix(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  char first[5] = {};
  file.read(first, sizeof first);
  return std::memcmp(first, "\x89VMAT", sizeof first) == 0 ? read_vmat(path) : read_dataset(path);
}

}  // namespace vismat::cli
