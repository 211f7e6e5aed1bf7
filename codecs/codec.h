// The table of codecs: matrix to bytes and back. Tests, benchmarks and the program loop over it.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "matrix/byte_reader.h"
#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

class RowDecoder;

/// What an encoder makes. Neither part carries a header, so sizes compare fairly.
struct Encoded {
  std::vector<std::byte> payload;
  /// Where parts of the payload lie, for readers of one part. Codecs over a tree: one varint a node that has children, the
  /// bytes of its part; a client that stores each part in its node, as paper 002 does (Figure 2), has no use for it. Codecs
  /// with open_rows: where rows begin (row_codec.h). Others: empty.
  std::vector<std::byte> index;
  bool operator==(const Encoded&) const = default;
};

/// What a codec's tree stands over. columns: its nodes are the columns, and the matrix is monotone over it. rows: binary, and
/// each leaf holds a row.
enum class TreeOver { nothing, columns, rows };

/// A plain value. `name` is stored in files and never reused for other bytes.
struct Codec {
  std::string_view name;
  std::string_view contents;  // what the payload holds, for tables
  /// The tree that it wants; the others ignore it.
  TreeOver over_tree = TreeOver::nothing;
  bool wants_row_order =
      false;  // run lengths follow the rows' order; the paper reorders view cells before these
  /// Throws std::invalid_argument where the tree that it wants is missing, does not fit or is not monotone.
  Encoded (*encode)(const VisibilityMatrix&, const ObjectTree*) = nullptr;
  /// Throws FormatError on any bytes that encode() cannot have made for this shape and tree, in time and
  /// memory linear in the payload and the matrix that it describes.
  VisibilityMatrix (*decode)(std::span<const std::byte> payload, std::span<const std::byte> index, Shape,
                             const ObjectTree*) = nullptr;
  /// Where any row can be read alone: its decoder, from the payload's model. Otherwise null. See row_reader.h.
  std::unique_ptr<const RowDecoder> (*open_rows)(std::span<const std::byte> model, Shape) = nullptr;
  std::uint32_t rows_per_part = 1;  // rows that share their bytes
};

/// Of a dataset's or a file's two trees the one for this codec; null if there is none.
template <typename TwoTrees>
const ObjectTree* tree_for(const Codec& codec, const TwoTrees& of) {
  const auto& tree = codec.over_tree == TreeOver::rows ? of.row_tree : of.tree;
  return tree ? &*tree : nullptr;
}

constexpr Codec whole_file_codec(std::string_view name, std::string_view contents,
                                 decltype(Codec::encode) encode, decltype(Codec::decode) decode) {
  Codec codec{};
  codec.name = name;
  codec.contents = contents;
  codec.encode = encode;
  codec.decode = decode;
  return codec;
}

/// Our own codecs; they need the standard library alone.
std::span<const Codec> own_codecs();

}  // namespace vismat
