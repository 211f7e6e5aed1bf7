// Every codec in the table, on every matrix: round trip, damage, single nodes, golden bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "codecs/baseline_codecs.h"
#include "codecs/bitmap.h"
#include "codecs/container.h"
#include "codecs/tree_coding.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

std::string test_name(const testing::TestParamInfo<Codec>& codec) {
  std::string name(codec.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

using test::NamedMatrix;

struct Case {
  VisibilityMatrix matrix;
  std::optional<ObjectTree> tree;
  const ObjectTree* tree_or_null() const { return tree ? &*tree : nullptr; }
};

// Codecs over a tree of columns get the same objects as nodes of an even tree, those over rows an even tree of pairs.
Case case_for(const Codec& codec, const VisibilityMatrix& objects, std::uint32_t arity = 4) {
  if (codec.over_tree == TreeOver::nothing) return {objects, std::nullopt};
  if (codec.over_tree == TreeOver::rows) {
    const std::uint32_t rows = objects.shape().rows;
    return {objects, rows == 0 ? ObjectTree{} : test::even_tree(rows, 2)};
  }
  if (objects.shape().columns == 0) return {objects, ObjectTree{}};
  const ObjectTree tree = test::even_tree(objects.shape().columns, arity);
  return {nodes_from_objects(objects, tree), tree};
}

class EveryCodec : public testing::TestWithParam<Codec> {};

TEST_P(EveryCodec, RoundTripsEveryMatrix) {
  for (const NamedMatrix& m : test::assorted_matrices()) {
    for (const std::uint32_t arity : {2u, 4u, 30u}) {
      const Case c = case_for(GetParam(), m.matrix, arity);
      const Encoded encoded = GetParam().encode(c.matrix, c.tree_or_null());
      EXPECT_EQ(GetParam().decode(encoded.payload, encoded.index, c.matrix.shape(), c.tree_or_null()),
                c.matrix)
          << m.name;
      EXPECT_EQ(GetParam().encode(c.matrix, c.tree_or_null()), encoded)
          << m.name << ": same input, other bytes";
    }
  }
}

TEST_P(EveryCodec, RefusesEveryPrefixAndOneMoreByte) {
  const Case c = case_for(GetParam(), test::clustered_matrix({40, 50}, 5));
  Encoded e = GetParam().encode(c.matrix, c.tree_or_null());
  const auto decode = [&](std::span<const std::byte> payload, std::span<const std::byte> index) {
    return GetParam().decode(payload, index, c.matrix.shape(), c.tree_or_null());
  };
  for (std::size_t n = 0; n < e.payload.size(); ++n) {
    // Where all rows escaped there is no index, and no payload at all may stand for as many empty rows.
    if (n == 0 && e.index.empty() && GetParam().open_rows != nullptr) continue;
    EXPECT_THROW(decode(std::span(e.payload).first(n), e.index), FormatError)
        << "payload of " << n << " bytes";
  }
  for (std::size_t n = 0; n < e.index.size(); ++n) {
    EXPECT_THROW(decode(e.payload, std::span(e.index).first(n)), FormatError) << "index of " << n << " bytes";
  }
  e.payload.push_back(std::byte{0});
  EXPECT_THROW(decode(e.payload, e.index), FormatError);
}

// A flipped bit either decodes to some matrix of the right shape or is refused; nothing else may happen.
TEST_P(EveryCodec, SurvivesFlippedBits) {
  const Case c = case_for(GetParam(), test::clustered_matrix({40, 50}, 6));
  const Encoded good = GetParam().encode(c.matrix, c.tree_or_null());
  for (std::size_t bit = 0; bit < good.payload.size() * 8; ++bit) {
    Encoded bad = good;
    bad.payload[bit / 8] ^= std::byte{1} << (bit % 8);
    try {
      EXPECT_EQ(GetParam().decode(bad.payload, bad.index, c.matrix.shape(), c.tree_or_null()).shape(),
                c.matrix.shape());
    } catch (const FormatError&) {
    }
  }
}

TEST_P(EveryCodec, ContainerKeepsEverything) {
  const Case c = case_for(GetParam(), test::clustered_matrix({40, 50}, 7));
  Container container = compress(c.matrix, GetParam(), c.tree_or_null());
  std::vector<std::uint32_t> order(40);
  for (std::uint32_t i = 0; i < 40; ++i) order[i] = i * 7 % 40;
  container.row_order = Permutation::from_new_of_old(order);
  container.column_order = Permutation::identity(c.matrix.shape().columns);
  if (!container.row_tree) container.row_tree = test::even_tree(40, 3);
  container.facts = "guarantee: exact\n";
  EXPECT_EQ(read_container(write_container(container)), container);
  container.row_order.reset();
  std::vector<std::uint32_t> groups(100);
  for (std::uint32_t i = 0; i < 100; ++i) groups[i] = (i + i * i) % 40;
  for (std::uint32_t i = 0; i < 40; ++i) groups[i + 30] = i;
  container.row_groups = Partition::from_group_of_member(groups);
  const Container back = read_container(write_container(container));
  EXPECT_EQ(back, container);
  EXPECT_EQ(decompress(back, GetParam()), c.matrix);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryCodec, testing::ValuesIn(all_codecs()), test_name);

// Row n: the set of node n, the obvious way.
VisibilityMatrix sets_of_nodes(const Codec& codec, const Case& c) {
  return transpose(codec.over_tree == TreeOver::columns ? c.matrix : nodes_from_objects(transpose(c.matrix), *c.tree));
}

class EveryTreeCodec : public testing::TestWithParam<Codec> {};

TEST_P(EveryTreeCodec, ReadsEachNodeAlone) {
  const Case c = case_for(GetParam(), test::clustered_matrix({60, 90}, 8));
  const Encoded e = GetParam().encode(c.matrix, &*c.tree);
  const VisibilityMatrix truth = sets_of_nodes(GetParam(), c);
  const NodeReader reader(GetParam().name, e.payload, e.index, c.matrix.shape(), *c.tree);
  std::uint64_t bytes = 0;
  for (std::uint32_t n = 0; n < c.tree->size(); ++n) {
    EXPECT_TRUE(std::ranges::equal(reader.set(n).members, truth.row(n))) << "node " << n;
    bytes += reader.part_bytes(n);
  }
  EXPECT_LE(bytes, e.payload.size());
}

// The other parts are overwritten: if children() read them, the answer would change or be refused.
TEST_P(EveryTreeCodec, ReadsNoOtherNodesPart) {
  const Case c = case_for(GetParam(), test::clustered_matrix({60, 90}, 9));
  const Encoded good = GetParam().encode(c.matrix, &*c.tree);
  const VisibilityMatrix truth = sets_of_nodes(GetParam(), c);
  std::uint64_t parts = 0;
  const NodeReader measure(GetParam().name, good.payload, good.index, c.matrix.shape(), *c.tree);
  for (std::uint32_t n = 0; n < c.tree->size(); ++n) parts += measure.part_bytes(n);
  std::uint64_t begin = good.payload.size() - parts;
  for (std::uint32_t n = 0; n < c.tree->size(); ++n) {
    std::vector<std::byte> payload(good.payload);
    const std::uint64_t end = begin + measure.part_bytes(n);
    for (std::uint64_t i = good.payload.size() - parts; i < payload.size(); ++i) {
      if (i < begin || i >= end) payload[i] = std::byte{0xa5};
    }
    const NodeReader reader(GetParam().name, payload, good.index, c.matrix.shape(), *c.tree);
    const auto children = reader.children(measure.set(n));
    ASSERT_EQ(children.size(), c.tree->children(n).size());
    for (std::size_t i = 0; i < children.size(); ++i) {
      EXPECT_TRUE(std::ranges::equal(children[i].members, truth.row(c.tree->children(n)[i])));
    }
    begin = end;
  }
}

// gotsman_test.cpp has what those over a tree of rows refuse.
class EveryCodecOverColumns : public EveryTreeCodec {};

TEST_P(EveryCodecOverColumns, RefusesMatricesThatDoNotFitTheTree) {
  const ObjectTree tree = test::even_tree(4);
  const auto hidden_parent = VisibilityMatrix::from_rows({{0, 1}, {2}}, tree.size());
  EXPECT_THROW(GetParam().encode(hidden_parent, &tree), std::invalid_argument);
  EXPECT_THROW(GetParam().encode(VisibilityMatrix(Shape{2, 3}), &tree), std::invalid_argument);
  EXPECT_THROW(GetParam().encode(VisibilityMatrix(Shape{2, tree.size()}), nullptr), std::invalid_argument);
}

// One node's children hold 2^31 bits at most: a tree and a shape out of a hostile file may claim far more.
TEST_P(EveryCodecOverColumns, RefusesAbsurdNodes) {
  const std::uint32_t leafs = 1u << 16;
  const ObjectTree tree = test::even_tree(leafs, leafs);
  const std::vector<std::byte> payload = {std::byte{1}}, index = {std::byte{0}};
  EXPECT_THROW(GetParam().decode(payload, index, {1u << 20, tree.size()}, &tree), FormatError);
}

std::vector<Codec> tree_codecs(bool over_rows) {
  std::vector<Codec> codecs = all_codecs();
  std::erase_if(codecs, [=](const Codec& c) {
    return c.over_tree == TreeOver::nothing || (c.over_tree == TreeOver::rows && !over_rows);
  });
  return codecs;
}
INSTANTIATE_TEST_SUITE_P(Table, EveryTreeCodec, testing::ValuesIn(tree_codecs(true)), test_name);
INSTANTIATE_TEST_SUITE_P(Table, EveryCodecOverColumns, testing::ValuesIn(tree_codecs(false)), test_name);

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
  const Case c = case_for(find_codec("zach0"), test::clustered_matrix({24, 16}, 11));
  std::map<std::string, std::pair<std::size_t, std::uint64_t>> found;
  for (const Codec& codec : own_codecs()) {
    const ObjectTree rows = test::even_tree(24, 2);
    const Encoded e = codec.encode(c.matrix, codec.over_tree == TreeOver::rows ? &rows : &*c.tree);
    found[std::string(codec.name)] = {e.payload.size(), fnv1a(e.payload)};
  }
  const Container container = compress(c.matrix, find_codec("zach3-huffman"), &*c.tree);
  const auto file = write_container(container);
  found[".vmat"] = {file.size(), fnv1a(file)};
  const std::map<std::string, std::pair<std::size_t, std::uint64_t>> golden = {
      {".vmat", {266, 1459020191328048001u}},
      {"bitmap", {72, 86685243641351298u}},
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
