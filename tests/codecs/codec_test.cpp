// Every codec in the table, on every matrix: round trip, damage, single nodes, golden bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/container.h"
#include "programs/prepared_for.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"
#include "tests/table_name.h"

namespace vismat {
namespace {

using test::NamedMatrix;

// The same objects as each codec needs them: as nodes of an even tree, or with an even tree of pairs over the rows.
Dataset case_for(const Codec& codec, const VisibilityMatrix& objects, std::uint32_t arity = 4) {
  const auto [rows, columns] = objects.shape();
  Dataset data;
  data.matrix = objects;
  data.source.tree = columns == 0 ? ObjectTree{} : test::even_tree(columns, arity);
  data.source.row_tree = rows == 0 ? ObjectTree{} : test::even_tree(rows, 2);
  return prepared_for(codec, std::move(data), {.orders = false});
}

Encoded encoded(const Codec& codec, const Dataset& c) {
  return codec.encode(c.matrix, side_of(codec, c), {});
}
VisibilityMatrix decoded(const Codec& codec, const Encoded& e, const Dataset& c) {
  return decode(codec, e, c.matrix.shape(), side_of(codec, c));
}

class EveryCodec : public testing::TestWithParam<Codec> {};

TEST_P(EveryCodec, RoundTripsEveryMatrix) {
  std::vector<std::uint32_t> arities = {4};
  if (GetParam().needs.tree == TreeOver::columns) arities = {2, 4, 30};
  for (const NamedMatrix& m : test::assorted_matrices()) {
    for (const std::uint32_t arity : arities) {
      const Dataset c = case_for(GetParam(), m.matrix, arity);
      const Encoded e = encoded(GetParam(), c);
      EXPECT_EQ(decoded(GetParam(), e, c), c.matrix) << m.name;
      EXPECT_EQ(encoded(GetParam(), c), e) << m.name << ": same input, other bytes";
    }
  }
}

TEST_P(EveryCodec, RefusesEveryPrefixAndOneMoreByte) {
  const Dataset c = case_for(GetParam(), test::clustered_matrix({40, 50}, 5));
  Encoded e = encoded(GetParam(), c);
  const auto first = [](std::span<const std::byte> bytes, std::size_t n) {
    return std::vector<std::byte>(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
  };
  for (std::size_t n = 0; n < e.payload.size(); ++n) {
    // Where all rows escaped the index tells their number alone, and no payload at all may stand for as many empty rows.
    if (n == 0 && e.index.size() == 1) continue;
    EXPECT_THROW(decoded(GetParam(), {first(e.payload, n), e.index}, c), FormatError)
        << "payload of " << n << " bytes";
  }
  for (std::size_t n = 0; n < e.index.size(); ++n)
    EXPECT_THROW(decoded(GetParam(), {e.payload, first(e.index, n)}, c), FormatError)
        << "index of " << n << " bytes";
  e.payload.push_back(std::byte{0});
  EXPECT_THROW(decoded(GetParam(), e, c), FormatError);
  e.payload.pop_back();
  e.index.push_back(std::byte{0});
  EXPECT_THROW(decoded(GetParam(), e, c), FormatError);
}

// A flipped bit either decodes to some matrix of the right shape or is refused; nothing else may happen.
TEST_P(EveryCodec, SurvivesFlippedBits) {
  const Dataset c = case_for(GetParam(), test::clustered_matrix({40, 50}, 6));
  const Encoded good = encoded(GetParam(), c);
  for (std::size_t bit = 0; bit < good.payload.size() * 8; bit += test::sanitized ? 3 : 1) {
    Encoded bad = good;
    bad.payload[bit / 8] ^= std::byte{1} << (bit % 8);
    try {
      EXPECT_EQ(decoded(GetParam(), bad, c).shape(), c.matrix.shape());
    } catch (const FormatError&) {
    }
  }
}

TEST_P(EveryCodec, ContainerKeepsEverything) {
  Codec codec = GetParam();
  codec.needs.distinct = false;  // groups would stand for the orders
  const Dataset c = case_for(codec, test::clustered_matrix({40, 50}, 7));
  const std::uint32_t columns = c.matrix.shape().columns;
  Container container = compress(c, GetParam());
  std::vector<std::uint32_t> order(40);
  for (std::uint32_t i = 0; i < 40; ++i) order[i] = i * 7 % 40;
  SourceMap& source = container.source;
  source.row_order = Permutation::from_new_of_old(order);
  source.column_order = Permutation::identity(columns);
  if (GetParam().needs.tree != TreeOver::rows) source.row_tree = test::even_tree(40, 3);
  for (std::uint32_t r = 0; r < 40; ++r) source.row_names.push_back("cell " + std::to_string(r / 3));
  source.column_names.assign(columns, "");
  for (std::uint32_t i = 0; i < columns; ++i) source.column_levels.push_back({i * 5 % 17, i / 17});
  container.facts = "guarantee: exact\n";
  container.encoded.bands = {0, 8, 9};
  container.encoded.shared = {{std::byte{7}}, {std::byte{0}, std::byte{1}}};
  container.boxes = BoxSums{1, 0xfffffffe};
  EXPECT_EQ(read_container(write_container(container)), container);
  container.boxes.reset();
  source.row_order.reset();
  std::vector<std::uint32_t> groups(100);
  for (std::uint32_t i = 0; i < 100; ++i) groups[i] = (i + i * i) % 40;
  for (std::uint32_t i = 0; i < 40; ++i) groups[i + 30] = i;
  source.row_groups = Partition::from_group_of_member(groups);
  source.row_names.resize(100);
  const Container back = read_container(write_container(container));
  EXPECT_EQ(back, container);
  // Sections that the codec cannot have made are refused with its payload.
  EXPECT_THROW(decompress(back, GetParam()), FormatError);
  container.encoded = encoded(GetParam(), c);
  EXPECT_EQ(decompress(read_container(write_container(container)), GetParam()), c.matrix);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryCodec, testing::ValuesIn(all_codecs()), test::table_name);

// Row n: the set of node n, the obvious way.
VisibilityMatrix sets_of_nodes(const Codec& codec, const Dataset& c) {
  return transpose(codec.needs.tree == TreeOver::columns
                       ? c.matrix
                       : nodes_from_objects(transpose(c.matrix), *c.source.row_tree));
}

class EveryTreeCodec : public testing::TestWithParam<Codec> {};

TEST_P(EveryTreeCodec, ReadsEachNodeAlone) {
  const Dataset c = case_for(GetParam(), test::clustered_matrix({60, 90}, 8));
  const ObjectTree& tree = *tree_for(GetParam(), c.source);
  const Encoded e = encoded(GetParam(), c);
  const VisibilityMatrix truth = sets_of_nodes(GetParam(), c);
  const NodeReader reader(GetParam(), Parts(e), c.matrix.shape(), tree);
  std::uint64_t bytes = 0;
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    EXPECT_TRUE(std::ranges::equal(reader.set(n).members, truth.row(n))) << "node " << n;
    bytes += reader.part_bytes(n);
  }
  EXPECT_LE(bytes, e.payload.size());
}

// The other parts are overwritten: if children() read them, the answer would change or be refused.
TEST_P(EveryTreeCodec, ReadsNoOtherNodesPart) {
  const Dataset c = case_for(GetParam(), test::clustered_matrix({60, 90}, 9));
  const ObjectTree& tree = *tree_for(GetParam(), c.source);
  const Encoded good = encoded(GetParam(), c);
  const VisibilityMatrix truth = sets_of_nodes(GetParam(), c);
  std::uint64_t parts = 0;
  const NodeReader measure(GetParam(), Parts(good), c.matrix.shape(), tree);
  for (std::uint32_t n = 0; n < tree.size(); ++n) parts += measure.part_bytes(n);
  std::uint64_t begin = good.payload.size() - parts;
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    std::vector<std::byte> payload(good.payload);
    const std::uint64_t end = begin + measure.part_bytes(n);
    for (std::uint64_t i = good.payload.size() - parts; i < payload.size(); ++i) {
      if (i < begin || i >= end) payload[i] = std::byte{0xa5};
    }
    const Encoded overwritten{payload, good.index};
    const NodeReader reader(GetParam(), Parts(overwritten), c.matrix.shape(), tree);
    const auto children = reader.children(measure.set(n));
    ASSERT_EQ(children.size(), tree.children(n).size());
    for (std::size_t i = 0; i < children.size(); ++i) {
      EXPECT_TRUE(std::ranges::equal(children[i].members, truth.row(tree.children(n)[i])));
    }
    begin = end;
  }
}

// gotsman_test.cpp has what those over a tree of rows refuse.
class EveryCodecOverColumns : public EveryTreeCodec {};

TEST_P(EveryCodecOverColumns, RefusesMatricesThatDoNotFitTheTree) {
  const ObjectTree tree = test::even_tree(4);
  const auto hidden_parent = VisibilityMatrix::from_rows({{0, 1}, {2}}, tree.size());
  EXPECT_THROW(GetParam().encode(hidden_parent, {&tree, {}, {}}, {}), std::invalid_argument);
  EXPECT_THROW(GetParam().encode(VisibilityMatrix(Shape{2, 3}), {&tree, {}, {}}, {}), std::invalid_argument);
  EXPECT_THROW(GetParam().encode(VisibilityMatrix(Shape{2, tree.size()}), {}, {}), std::invalid_argument);
}

// One node's children hold 2^31 bits at most: a tree and a shape out of a hostile file may claim far more.
TEST_P(EveryCodecOverColumns, RefusesAbsurdNodes) {
  const std::uint32_t leafs = 1u << 16;
  const ObjectTree tree = test::even_tree(leafs, leafs);
  const std::vector<std::uint64_t> starts = {1};
  const Encoded hostile{{std::byte{1}}, part_index_bytes(starts, 1)};
  EXPECT_THROW(decode(GetParam(), hostile, {1u << 20, tree.size()}, {&tree, {}, {}}), FormatError);
}

std::vector<Codec> tree_codecs(bool over_rows) {
  std::vector<Codec> codecs = all_codecs();
  std::erase_if(codecs, [=](const Codec& c) {
    return c.needs.tree == TreeOver::nothing || (c.needs.tree == TreeOver::rows && !over_rows);
  });
  return codecs;
}
INSTANTIATE_TEST_SUITE_P(Table, EveryTreeCodec, testing::ValuesIn(tree_codecs(true)), test::table_name);
INSTANTIATE_TEST_SUITE_P(Table, EveryCodecOverColumns, testing::ValuesIn(tree_codecs(false)),
                         test::table_name);

TEST(Bitmap, IsPaddedToBytes) {
  EXPECT_EQ(bitmap_size({23814, 5461}), 16264962u);  // paper 002, Table 2, artificial 2
  const auto bytes = bitmap_bytes(VisibilityMatrix::from_rows({{0, 9}, {}, {3}}, 10));
  const std::vector<std::byte> golden = {std::byte{1}, std::byte{2}, {}, {}, std::byte{8}, {}};
  EXPECT_EQ(bytes, golden);
  EXPECT_THROW(matrix_from_bitmap(std::vector<std::byte>{std::byte{0}, std::byte{4}}, {1, 10}), FormatError);
}

std::uint64_t fnv1a(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (const std::byte b : bytes) sum = (sum ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  return sum;
}

// Our own formats byte for byte: a change here is a new format and wants a new name.
TEST(GoldenBytes, OfOurOwnFormats) {
  const Dataset c = case_for(find_codec("zach0"), test::clustered_matrix({24, 16}, 11));
  std::map<std::string, std::pair<std::size_t, std::uint64_t>> found;
  for (const Codec& codec : own_codecs()) {
    const ObjectTree rows = test::even_tree(24, 2);
    const Encoded e =
        codec.encode(c.matrix, {codec.needs.tree == TreeOver::rows ? &rows : &*c.source.tree, {}, {}}, {});
    found[std::string(codec.name)] = {e.payload.size(), fnv1a(e.payload)};
  }
  const Container container = compress(c, find_codec("zach3-huffman"));
  const auto file = write_container(container);
  found[".vmat"] = {file.size(), fnv1a(file)};
  const std::map<std::string, std::pair<std::size_t, std::uint64_t>> golden = {
      {".vmat", {233, 942100846285646026u}},
      {"bitmap", {72, 86685243641351298u}},
      {"bv", {49, 4599095778035380935u}},
      {"delimiter", {60, 15428225424264872396u}},
      {"elias-fano", {66, 10241265575966090890u}},
      {"gotsman1", {142, 14809188824877630091u}},
      {"gotsman2", {68, 14833183760895674540u}},
      {"gotsman3", {65, 11425681779831965408u}},
      {"gotsman3-context", {41, 7452777786036290u}},
      {"pair-ans", {90, 10896553730154257044u}},
      {"pair-delta", {52, 16303718654085581589u}},
      {"pair-gamma", {48, 16518214658524934942u}},
      {"pair-huffman", {66, 10241265575966090890u}},
      {"pair-huffman-shared", {69, 3430548179490130901u}},
      {"pair-interpolative", {66, 10241265575966090890u}},
      {"pair-lzw", {66, 10241265575966090890u}},
      {"pair-rice", {66, 10241265575966090890u}},
      {"panne", {107, 13002158662707628462u}},
      {"quake-rle", {85, 6716608406474686327u}},
      {"rows-fast-bits", {126, 6970393524536708007u}},
      {"rows-fast-ids", {75, 9533530713938457632u}},
      {"rows-quick", {47, 14751705073656831895u}},
      {"rows-small", {39, 987579818825591710u}},
      {"zach0", {35, 14570556128884471082u}},
      {"zach1", {43, 11013996029347175951u}},
      {"zach2", {35, 16815643607434460705u}},
      {"zach3-huffman", {65, 3395907850818163285u}},
      {"zach3-range", {107, 5153034281124450344u}},
      {"zach4-huffman", {46, 8980485470763333015u}},
      {"zach4-range", {78, 6340890600240907199u}},
  };
  EXPECT_EQ(found, golden);
}

TEST(FindCodec, ListsTheNames) {
  try {
    find_codec("zip");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("zach3-huffman"), std::string::npos);
  }
}

}  // namespace
}  // namespace vismat
