// Subset coding over trees of view cells: each method against bits written the obvious way, rows and nodes alone, damage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <thread>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/context_tree.h"
#include "codecs/entropy/range_coder.h"
#include "codecs/tree/tree_coding.h"
#include "matrix/permutation.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

Side over(const ObjectTree& tree) {
  return {&tree, {}, {}};
}

const std::vector<std::string> gotsman_names = {"gotsman1", "gotsman2", "gotsman3", "gotsman3-context"};

// v(node) of each node as text of 0 and 1, an object a character: what the rows below see.
std::vector<std::string> objects_seen(const VisibilityMatrix& matrix, const ObjectTree& tree) {
  std::vector<std::string> seen(tree.size(), std::string(matrix.shape().columns, '0'));
  for (std::uint32_t node = 0; node < tree.size(); ++node) {
    if (tree.object_of_node()[node] == ObjectTree::none) continue;
    const auto row = matrix.row(tree.object_of_node()[node]);
    for (std::uint32_t n = node; n != ObjectTree::none; n = tree.parent_of_node()[n]) {
      char* const text = seen[n].data();
      for (const std::uint32_t id : row) text[id] = '1';
    }
  }
  return seen;
}

// x[y]: the bits of x at the ones of y.
std::string relative(const std::string& x, const std::string& y) {
  std::string bits;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (y[i] == '1') bits += x[i];
  }
  return bits;
}

void append_bits(std::vector<std::byte>& out, const std::string& bits) {
  BitWriter writer(out);
  for (const char bit : bits) writer.put(bit == '1', 1);
  writer.flush();
}

// The payload of method 1, 2 or 3 as the papers' notation has it.
std::vector<std::byte> obvious_payload(int method, const VisibilityMatrix& matrix, const ObjectTree& tree) {
  const std::vector<std::string> seen = objects_seen(matrix, tree);
  const std::string root = tree.size() == 0 ? "" : seen[0];
  const bool everything = tree.size() == 0 || root.find('0') == std::string::npos;
  std::vector<std::byte> out = {static_cast<std::byte>(everything)};
  if (!everything) append_bits(out, root);
  for (std::uint32_t node = 0; node < tree.size(); ++node) {
    if (tree.children(node).empty()) continue;
    const std::string &a = seen[node], &b = seen[tree.children(node)[0]], &c = seen[tree.children(node)[1]];
    append_bits(out, method == 1   ? b + c
                     : method == 2 ? relative(b, a) + relative(c, a)
                                   : relative(b, a) + relative(c, b));
  }
  return out;
}

ObjectTree pairs(std::uint32_t rows) {
  return rows == 0 ? ObjectTree{} : test::even_tree(rows, 2);
}

// Row i is all that hangs off the i-th node of a chain; the last two share a parent.
ObjectTree chain(std::uint32_t rows) {
  std::vector<std::uint32_t> parents = {ObjectTree::none}, row_of_node = {ObjectTree::none};
  std::uint32_t parent = 0;
  for (std::uint32_t r = 0; r + 1 < rows; ++r) {
    const auto leaf = static_cast<std::uint32_t>(parents.size());
    parents.insert(parents.end(), {parent, parent});
    row_of_node.push_back(r);
    row_of_node.push_back(r + 2 == rows ? r + 1 : ObjectTree::none);
    parent = leaf + 1;
  }
  return ObjectTree::from_parents(parents, row_of_node, rows);
}

TEST(Gotsman, WritesWhatTheNotationSays) {
  for (const auto& [name, matrix] : test::assorted_matrices()) {
    for (int method = 1; method <= 3; ++method) {
      const Codec& codec = find_codec(gotsman_names[static_cast<std::size_t>(method) - 1]);
      const ObjectTree tree = pairs(matrix.shape().rows);
      EXPECT_EQ(codec.encode(matrix, over(tree), {}).payload, obvious_payload(method, matrix, tree))
          << codec.name << ", " << name;
    }
  }
}

TEST(Gotsman, RoundTripsOverAChain) {
  const VisibilityMatrix matrix = test::clustered_matrix({70, 200}, 21);
  const ObjectTree tree = chain(70);
  for (const std::string& name : gotsman_names) {
    const Encoded e = find_codec(name).encode(matrix, over(tree), {});
    EXPECT_EQ(decode(find_codec(name), e, matrix.shape(), over(tree)), matrix) << name;
  }
}

TEST(Gotsman, AnyRowAndNodeAloneIsThatOfTheWhole) {
  const VisibilityMatrix matrix = test::clustered_matrix({50, 300}, 22);
  for (const ObjectTree& tree : {pairs(50), chain(50)}) {
    const std::vector<std::string> seen = objects_seen(matrix, tree);
    for (const std::string& name : gotsman_names) {
      const Encoded e = find_codec(name).encode(matrix, over(tree), {});
      const NodeReader reader(find_codec(name), Parts(e), matrix.shape(), tree);
      for (std::uint32_t row = 0; row < 50; ++row) {
        const std::uint32_t node = reader.node_of_row(row);
        EXPECT_TRUE(std::ranges::equal(reader.set(node).members, matrix.row(row))) << name << ", row " << row;
        EXPECT_LT(reader.cost(node).bytes, e.payload.size()) << name;
      }
      EXPECT_THROW(reader.node_of_row(50), std::out_of_range);
      for (std::uint32_t node = 0; node < tree.size(); ++node) {
        std::string alone(300, '0');
        for (const std::uint32_t id : reader.set(node).members) alone[id] = '1';
        EXPECT_EQ(alone, seen[node]) << name << ", node " << node;
      }
    }
  }
}

TEST(Gotsman, AKeptPathGivesTheSameSets) {
  const VisibilityMatrix matrix = test::clustered_matrix({90, 300}, 23);
  const ObjectTree tree = pairs(90);
  for (const std::string& name : gotsman_names) {
    const Encoded e = find_codec(name).encode(matrix, over(tree), {});
    const NodeReader reader(find_codec(name), Parts(e), matrix.shape(), tree);
    NodePath path;
    Random random(1);
    for (int step = 0; step < 500; ++step) {
      const std::uint32_t node = random.below(tree.size());
      EXPECT_EQ(reader.set(node, path).members, reader.set(node).members) << name;
      EXPECT_EQ(path.last().node, node);
    }
  }
}

TEST(Gotsman, ThreadsShareAReader) {
  const VisibilityMatrix matrix = test::clustered_matrix({200, 300}, 24);
  const ObjectTree tree = pairs(200);
  const Encoded e = find_codec("gotsman3-context").encode(matrix, over(tree), {});
  const NodeReader reader(find_codec("gotsman3-context"), Parts(e), matrix.shape(), tree);
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      NodePath path;
      for (std::uint32_t row = t; row < 200; ++row)
        wrong[t] += !std::ranges::equal(reader.set(reader.node_of_row(row), path).members, matrix.row(row));
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

TEST(Gotsman, ContextsTakeAThirdOffTheThirdMethod) {
  const VisibilityMatrix matrix = test::clustered_matrix({1000, 400}, 25);
  const ObjectTree tree = pairs(1000);
  const std::size_t plain = find_codec("gotsman3").encode(matrix, over(tree), {}).payload.size(),
                    contexts = find_codec("gotsman3-context").encode(matrix, over(tree), {}).payload.size();
  EXPECT_LT(contexts, plain * 65 / 100);
}

// What is too much to learn from as a whole is learned from in part; the same bytes each time.
TEST(Gotsman, LearnsFromAPartOfLargeMatrices) {
  constexpr std::uint32_t rows = 1024, columns = test::sanitized ? 440 : 4400;
  std::vector<std::vector<std::uint32_t>> seen(rows);
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      if (r % 8 != 0 || c / 16 % 9 != r / 8 % 9) seen[r].push_back(c);
    }
  }
  const auto matrix = VisibilityMatrix::from_rows(seen, columns);
  const ObjectTree tree = pairs(rows);
  const std::uint64_t members =
      std::uint64_t{rows - 1} * columns;  // of the nodes above the rows, which all see everything
  ASSERT_TRUE(test::sanitized || members > std::uint64_t{1} << 22);
  const Encoded e = find_codec("gotsman3-context").encode(matrix, over(tree), {});
  EXPECT_EQ(find_codec("gotsman3-context").encode(matrix, over(tree), {}), e);
  EXPECT_EQ(decode(find_codec("gotsman3-context"), e, matrix.shape(), over(tree)), matrix);
}

TEST(Gotsman, RefusesTreesThatAreNotBinaryOverTheRows) {
  const VisibilityMatrix matrix = test::clustered_matrix({9, 40}, 27);
  const ObjectTree good = pairs(9);
  const auto with = [&](auto change) {
    std::vector<std::uint32_t> parents(good.parent_of_node().begin(), good.parent_of_node().end()),
        rows(good.object_of_node().begin(), good.object_of_node().end());
    change(parents, rows);
    return ObjectTree::from_parents(parents, rows, 9);
  };
  std::uint32_t leaf = 0;
  while (!good.children(leaf).empty()) ++leaf;
  const std::vector<ObjectTree> bad = {
      test::even_tree(9, 3),
      test::even_tree(8, 2),
      ObjectTree{},
      with([](auto&, auto& rows) { rows[0] = 0; }),
      with([&](auto&, auto& rows) { rows[leaf] = ObjectTree::none; }),
      with([&](auto&, auto& rows) { rows[leaf] = rows.back(); }),
      with([&](auto& parents, auto& rows) {
        parents.push_back(leaf);
        rows.push_back(rows[leaf]);
        rows[leaf] = ObjectTree::none;
      }),
  };
  for (const std::string& name : gotsman_names) {
    const Codec& codec = find_codec(name);
    const Encoded e = codec.encode(matrix, over(good), {});
    EXPECT_THROW(codec.encode(matrix, {}, {}), std::invalid_argument);
    EXPECT_THROW(decode(codec, e, matrix.shape()), FormatError);
    for (const ObjectTree& tree : bad) {
      EXPECT_THROW(codec.encode(matrix, over(tree), {}), std::invalid_argument) << name;
      EXPECT_THROW(decode(codec, e, matrix.shape(), over(tree)), FormatError) << name;
    }
  }
}

// Bytes that no encoder writes, for two rows over one node: 1 1 0 and 0 1 1 of three objects, all of them seen.
TEST(Gotsman, RefusesWhatNoEncoderWrites) {
  const ObjectTree tree = pairs(2);
  const auto matrix = VisibilityMatrix::from_rows({{0, 1}, {1, 2}}, 3);
  // `parts`: their bytes, from the payload's end on.
  const auto decode = [&](const char* name, std::vector<unsigned> payload, std::vector<unsigned> parts) {
    Encoded e;
    for (const unsigned b : payload) e.payload.push_back(static_cast<std::byte>(b));
    std::vector<std::uint64_t> starts;
    std::uint64_t at = payload.size() - std::accumulate(parts.begin(), parts.end(), 0u);
    for (const unsigned bytes : parts) {
      starts.push_back(at);
      at += bytes;
    }
    e.index = part_index_bytes(starts, payload.size());
    return vismat::decode(find_codec(name), e, {2, 3}, over(tree));
  };
  EXPECT_EQ(decode("gotsman1", {1, 0b110011}, {1}), matrix);
  EXPECT_EQ(decode("gotsman2", {1, 0b110011}, {1}), matrix);
  EXPECT_EQ(decode("gotsman3", {1, 0b10011}, {1}), matrix);
  for (const char* name : {"gotsman1", "gotsman2", "gotsman3"}) {
    EXPECT_THROW(decode(name, {2, 0b110011}, {1}), FormatError);            // a flag that is none
    EXPECT_THROW(decode(name, {0, 0b111, 0b110011}, {1, 1}), FormatError);  // a root that needs no part
    EXPECT_THROW(decode(name, {1, 0b1110011}, {1}), FormatError);           // padding
    EXPECT_THROW(decode(name, {1, 0b110011, 0}, {2}), FormatError);         // a byte too many
  }
  EXPECT_THROW(decode("gotsman1", {1, 0b010001}, {1}), FormatError);  // object 2 in neither child
  EXPECT_THROW(decode("gotsman2", {1, 0b010001}, {1}), FormatError);
  EXPECT_THROW(decode("gotsman1", {0, 0b011, 0b110011}, {1, 1}), FormatError);  // object 2 in a child alone

  // One byte more is refused under contexts too.
  const Codec& context = find_codec("gotsman3-context");
  const Encoded e = context.encode(matrix, over(tree), {});
  ASSERT_EQ(vismat::decode(context, e, {2, 3}, over(tree)), matrix);
  Encoded longer = e;
  longer.payload.push_back(std::byte{0});
  longer.index = part_index_bytes(std::vector<std::uint64_t>{Parts(e).model().size()}, longer.payload.size());
  EXPECT_THROW(vismat::decode(context, longer, {2, 3}, over(tree)), FormatError);
}

TEST(ContextTree, IsWrittenAsItIsRead) {
  Random random(3);
  std::vector<std::uint64_t> samples(20000);
  for (std::uint64_t& sample : samples) {
    sample = random.next() & 0xff;
    const bool bit = (sample >> 2 & sample >> 5 & 1) != 0 ? random.below(100) != 0
                                                          : (sample & 1) != 0 && random.below(3) == 0;
    if (bit) sample |= ContextTree::outcome;
  }
  const auto kept = samples;
  const ContextTree tree = ContextTree::grow(samples, 8);
  EXPECT_GT(tree.size(), 7u);
  double bits = 0;
  for (const std::uint64_t sample : kept) {
    const std::uint32_t share = tree.share(sample);
    ASSERT_GT(share, 0u);
    ASSERT_LT(share, 1u << 14);
    bits -= std::log2(((sample & ContextTree::outcome) != 0 ? share : (1 << 14) - share) / double{1 << 14});
  }
  EXPECT_LT(
      bits,
      20000 * .38);  // a fourth of the samples takes .08 bits each, 3/8 .92 and 3/8 none: .365 on the mean

  std::vector<std::byte> bytes;
  tree.write(bytes);
  ByteReader in(bytes, "tree");
  const ContextTree back = ContextTree::read(in, 8);
  EXPECT_EQ(in.left(), 0u);
  for (std::uint64_t context = 0; context < 256; ++context)
    EXPECT_EQ(back.share(context), tree.share(context));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    ByteReader prefix(std::span<const std::byte>(bytes).first(n), "tree");
    EXPECT_THROW(ContextTree::read(prefix, 8), FormatError);
  }
  ByteReader few(bytes, "tree");
  EXPECT_THROW(ContextTree::read(few, 2), FormatError);  // questions that there are not
}

TEST(ContextTree, RefusesWhatIsNoTree) {
  const auto read = [](std::initializer_list<std::pair<unsigned, unsigned>> fields) {
    std::vector<std::byte> bytes;
    BitWriter bits(bytes);
    for (const auto& [value, count] : fields) bits.put(value, count);
    bits.flush();
    ByteReader in(bytes, "tree");
    return ContextTree::read(in, 44).share(0);
  };
  EXPECT_EQ(read({{0, 1}, {88, 8}}), 8192u);
  EXPECT_EQ(read({{0, 1}, {1, 8}}), 1u);
  EXPECT_EQ(read({{0, 1}, {129, 8}}), 16383u);
  EXPECT_EQ(read({{0, 1}, {9, 8}}), 9u);
  EXPECT_EQ(read({{0, 1}, {17, 8}}), 18u);
  EXPECT_THROW(read({{0, 1}, {0, 8}}), FormatError);
  EXPECT_THROW(read({{0, 1}, {89, 8}}), FormatError);
  EXPECT_THROW(read({{0, 1}, {128 + 88, 8}}), FormatError);    // even odds have one code
  EXPECT_THROW(read({{0, 1}, {88, 8}, {1, 1}}), FormatError);  // padding
  EXPECT_THROW(read({{1, 1}, {44, 6}, {0, 1}, {1, 8}, {0, 1}, {2, 8}}), FormatError);  // no such question
  EXPECT_THROW(read({{1, 1}, {3, 6}, {1, 1}, {3, 6}, {0, 1}, {1, 8}, {0, 1}, {2, 8}, {0, 1}, {3, 8}}),
               FormatError);
}

// Each stream of bits by each odds, and none that ends in other bytes.
TEST(RangeCoder, EndsInOneWay) {
  Random random(4);
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t ones = 1 + random.below((1 << 14) - 1), count = random.below(60);
    std::vector<bool> bits;
    std::vector<std::byte> bytes;
    RangeEncoder encoder(bytes);
    for (std::uint32_t i = 0; i < count; ++i) {
      bits.push_back(random.below(1 << 14) < ones);
      encoder.put_bit(bits.back(), ones);
    }
    encoder.finish();
    const auto read = [&](std::span<const std::byte> from) {
      RangeDecoder in(from);
      std::vector<bool> out;
      for (std::uint32_t i = 0; i < count; ++i) out.push_back(in.get_bit(ones));
      in.finish();
      return out;
    };
    EXPECT_EQ(read(bytes), bits);
    auto longer = bytes;
    longer.push_back(std::byte{0});
    EXPECT_THROW(read(longer), FormatError);
    for (std::size_t i = 0; i < longer.size(); ++i) {  // either other bits or no stream at all
      auto changed = i < bytes.size() ? bytes : longer;
      changed[i] ^= std::byte{1};
      try {
        EXPECT_NE(read(changed), bits) << "two streams for the same bits";
      } catch (const FormatError&) {
      }
    }
  }
}

}  // namespace
}  // namespace vismat
