// What a codec is: a method that turns a visibility matrix into bytes and back. own_codecs() is the table of ours;
// tests, benchmarks and the program loop over it.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/base/parallel.h"
#include "matrix/box.h"
#include "matrix/object_tree.h"
#include "matrix/permutation.h"
#include "matrix/source_map.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

class NodeCoder;
class Parts;
class RowSource;

/// The result of an encoder. No part of it has a header, so sizes can be compared fairly.
struct Encoded {
  std::vector<std::byte> payload;
  /// Where the parts of the payload begin (part_index.h): a part for each row, group of rows or tree node. Empty if the
  /// payload is one piece. A client that stores each part in its tree node, as Zach and Karner do [2003, Figure 2],
  /// needs no index.
  std::vector<std::byte> index = {};
  /// Sections of the model that parts share, by number. Each is read when it is first needed.
  std::vector<std::vector<std::byte>> shared = {};
  /// The first rows of the bands, which are decoded without the rows before them. Empty, or ascending from row 0.
  std::vector<std::uint32_t> bands = {};
  /// Where each row of the matrix stands in the payload, if rows were allowed to move. compress() puts it into the
  /// file's source map.
  std::optional<Permutation> row_order = {};
  bool operator==(const Encoded&) const = default;
  /// The bytes of payload, index and shared sections: what tables count.
  std::uint64_t bytes() const {
    std::uint64_t sum = payload.size() + index.size();
    for (const auto& section : shared) sum += section.size();
    return sum;
  }
};

/// Whose idea a codec is: our own, a published paper's, or what others use.
enum class Origin { ours, paper, baseline };
inline std::string_view to_string(Origin origin) {
  return origin == Origin::ours ? "ours" : origin == Origin::paper ? "paper" : "baseline";
}

/// What a codec's tree stands over. columns: the columns are the tree's nodes, and the matrix is monotone over it.
/// rows: the tree is binary, and each leaf holds a row.
enum class TreeOver { nothing, columns, rows };

/// What a codec needs of a dataset. prepared_for() in programs/ provides it, for the program, the benchmarks and the
/// tests.
struct Needs {
  TreeOver tree = TreeOver::nothing;  // without one it cannot encode
  bool row_order = false;             // rows in the greedy order: it codes runs that continue from row to row
  bool column_order = false;          // columns in the best order
  bool shared_order = false;          // one order for both sides of a square matrix
  bool distinct = false;              // equal rows and equal columns stored once
  bool boxes = false;                 // without the boxes of rows and columns it cannot encode
};

/// What writer and reader both know besides the payload. Borrowed.
struct Side {
  const ObjectTree* tree = nullptr;
  std::span<const Box> row_boxes, column_boxes;
};

/// Each codec says which of these it uses; most use none. As long as `seconds` is 0, the same matrix, side, effort and
/// seed give the same bytes with any number of threads.
struct EncodeOptions {
  unsigned effort = 0;   // 0: the effort of tables; up to Codec::highest_effort
  double seconds = 0;    // searches for that long; 0: until the codec's own rule ends the search
  unsigned threads = 0;  // 0: one for each core
  /// Codecs that order rows may store them in the order that suits them best; Encoded::row_order tells which.
  bool rows_may_move = false;
  std::uint64_t seed = 1;  // of the search
  Progress progress = {};  // the work done and the work in all
};

/// A codec as a plain value. `name` is stored in files and is never reused for other bytes.
struct Codec {
  std::string_view name;
  std::string_view contents;  // what the payload holds, for tables
  Origin origin = Origin::ours;
  Needs needs = {};
  bool slow_encode = false;         // takes milliseconds for a few dozen rows, seconds or minutes for a level
  bool orders_rows = false;         // has an order of rows of its own (EncodeOptions::rows_may_move)
  bool searches = false;            // encode() continues for EncodeOptions::seconds if they are given
  unsigned highest_effort = 0;      // of EncodeOptions::effort
  std::uint32_t rows_per_part = 1;  // row codecs: rows that share a part

  /// Throws std::invalid_argument if the side lacks what `needs` names or does not fit the matrix.
  Encoded (*encode)(const VisibilityMatrix&, const Side&, const EncodeOptions&) = nullptr;
  /// Decodes the whole matrix. Throws FormatError on any bytes that encode() cannot have made for this shape and side,
  /// and if there are more than `most` ones. Memory grows with what is decoded, not with what the shape claims.
  VisibilityMatrix (*decode)(const Parts&, Shape, const Side&, std::uint64_t most) = nullptr;
  /// Row codecs, and tree codecs over rows: opens the payload for reading single rows. Otherwise null. Copies what it
  /// needs of the parts; the bytes and the side are borrowed. Throws FormatError as decode() does.
  std::unique_ptr<const RowSource> (*open)(Parts, Shape, const Side&) = nullptr;
  /// Tree codecs: how the codec codes a node (tree_coding.h). Otherwise null.
  std::unique_ptr<NodeCoder> (*node_coder)() = nullptr;

  /// Whether this is a row codec: it decodes any row alone, without the path through a tree.
  bool rows_alone() const { return open != nullptr && needs.tree == TreeOver::nothing; }
};

/// The one of a matrix's two trees that this codec needs; null if the matrix lacks it.
inline const ObjectTree* tree_for(const Codec& codec, const SourceMap& source) {
  if (codec.needs.tree == TreeOver::nothing) return nullptr;
  const auto& tree = codec.needs.tree == TreeOver::rows ? source.row_tree : source.tree;
  return tree ? &*tree : nullptr;
}

/// The codec of that name; null if there is none. This is the one place where names are compared.
inline const Codec* codec_named(std::string_view name, std::span<const Codec> codecs) {
  const auto found = std::ranges::find(codecs, name, &Codec::name);
  return found == codecs.end() ? nullptr : &*found;
}
/// The codec that a file names. Throws FormatError if there is none.
inline const Codec& codec_of_file(std::string_view name, std::span<const Codec> codecs) {
  const Codec* const found = codec_named(name, codecs);
  if (found == nullptr) throw FormatError("codec '" + std::string(name) + "' is unknown here");
  return *found;
}

/// Our own codecs. They need only POSIX and the C++20 standard library.
std::span<const Codec> own_codecs();

}  // namespace vismat
