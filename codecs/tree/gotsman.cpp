// ALGORITHM. The codecs `gotsman...`: subset coding over a tree of view cells [Gotsman, Sudarsky, Fayman 1999].
//
// The captions of the paper's figures, as others print them, say this: A is the parent of B and C, v(A) is the union of
// v(B) and v(C), and x[y] are the bits of x at the ones of y. Three methods code v(B) and v(C):
//
//   gotsman1  v(B), v(C)                          2 bits for each object of the scene
//   gotsman2  v(B)[v(A)], v(C)[v(A)]              2 bits for each object of A
//   gotsman3  v(B)[v(A)], v(C)[v(B)[v(A)]]        1 bit or 2 for each object of A: what A sees and B does not, C sees
//
// The paper is not available to us; the following is reconstruction. Each node with children has one part, a leaf is
// one view cell, and B is the child with the lower number. The root's set comes before all parts if it is not
// everything. In gotsman1 a part alone gives v(B) and v(C); ours is read along the path from the root like the others,
// and is refused if v(B) or v(C) has what v(A) has not.
//
// gotsman3-context is ours. An object of A is one trit, {both, B only, C only}: a bit for both, and if it is not set, a
// bit for which. Each is range coded with the probability that a tree of questions (context_tree.h) gives it. There is
// one tree for each of the two bits, stored once, so any node can be read by its path alone. The questions ask what the
// reader knows:
//
//   - the trits of the objects numbered 1 and 2 below, and of the last two of the part
//   - whether A sees the objects numbered 1 and 2 above
//   - for n = 1, 2, 4, 6, 8, all: the last trit of this part of an object that agrees with this one in the n nearest
//     siblings along the path (history), or in all (kind). They save 8 % and 21 % of two levels' bytes in the natural order of
//     columns, 2 % in the best order
//   - whether the object is in the last four siblings' sets, and whether the object before agrees in four of them, or in all
//   - how long the last trit has been repeated; the shares of trits in the part so far; the view cells below A; whether A is a first child
//
// Tried and found worse: the sets of siblings at the objects next to this one (0.1 % to 0.4 %), more of the history as single
// questions (0.1 %), how well the next object agrees (0). Adaptation from part to part would prevent reading single
// nodes. The order of the columns matters more than any question: `best` takes 22 % to 36 % off two levels' view cells
// and 51 % to 70 % off their faces, but adds 4 % to artificial 1, whose columns are the nodes of a tree in its order
// (bench gotsman-tables).
#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/context_tree.h"
#include "codecs/entropy/range_coder.h"
#include "codecs/integer_codes/universal_codes.h"
#include "codecs/rows/pairs.h"
#include "codecs/tree/tree_coding.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

[[noreturn]] void refuse_root() {
  throw FormatError("the root has a part though everything is in its set");
}

bool all_ones(std::span<const std::uint8_t> bits) {
  return std::find(bits.begin(), bits.end(), std::uint8_t{0}) == bits.end();
}

// What the plain three share: the root's part is its bits.
class GotsmanBits : public NodeCoder {
 public:
  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    BitWriter bits(out);
    if (node.of_root)
      put_bits(bits, node.bits);
    else
      put_children(bits, node);
    bits.flush();
  }
  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    BitReader in(part);
    if (node.of_root) {
      get_bits(in, node.bits);
      if (all_ones(node.bits)) refuse_root();
    } else {
      get_children(in, node);
    }
    in.finish();
  }

 protected:
  virtual void put_children(BitWriter& out, const ChildBits& node) const = 0;
  virtual void get_children(BitReader& in, ChildBits& node) const = 0;
  static void check_union(const ChildBits& node) {
    const auto first = node.child(0), second = node.child(1);
    for (std::uint32_t p = 0; p < node.members; ++p) {
      if ((first[p] | second[p]) == 0)
        throw FormatError("neither child sees object " + std::to_string(node.set->members[p]) +
                          ", which the node sees");
    }
  }
};

class WholeSets : public GotsmanBits {
  void put_children(BitWriter& out, const ChildBits& node) const override {
    std::vector<std::uint8_t> objects(node.universe);
    for (const std::uint32_t child : {0, 1}) {
      for (std::uint32_t p = 0; p < node.members; ++p) objects[node.set->members[p]] = node.child(child)[p];
      put_bits(out, objects);
    }
  }
  void get_children(BitReader& in, ChildBits& node) const override {
    std::vector<std::uint8_t>& objects = node.memory;
    objects.assign(node.universe, 0);
    for (const std::uint32_t child : {0, 1}) {
      get_bits(in, objects);
      for (std::uint32_t p = 0; p < node.members; ++p) {
        node.bits[std::size_t{child} * node.members + p] = objects[node.set->members[p]];
        objects[node.set->members[p]] = 0;
      }
      const auto other = std::find(objects.begin(), objects.end(), std::uint8_t{1});
      if (other != objects.end())
        throw FormatError("a child sees object " + std::to_string(other - objects.begin()) +
                          ", which its parent does not");
    }
    check_union(node);
  }
};

class RelativeToParent : public GotsmanBits {
  void put_children(BitWriter& out, const ChildBits& node) const override { put_bits(out, node.bits); }
  void get_children(BitReader& in, ChildBits& node) const override {
    get_bits(in, node.bits);
    check_union(node);
  }
};

class RelativeToSibling : public GotsmanBits {
  void put_children(BitWriter& out, const ChildBits& node) const override {
    const auto first = node.child(0), second = node.child(1);
    put_bits(out, first);
    std::vector<std::uint8_t> shared(node.members);
    std::size_t count = 0;
    for (std::uint32_t p = 0; p < node.members; ++p) {
      shared[count] = second[p];
      count += first[p];
    }
    put_bits(out, std::span(shared).first(count));
  }
  void get_children(BitReader& in, ChildBits& node) const override {
    const auto first = std::span(node.bits).first(node.members),
               second = std::span(node.bits).subspan(node.members);
    get_bits(in, first);
    for (std::uint32_t p = 0; p < node.members; ++p)
      second[p] = first[p] == 0 ? 1 : static_cast<std::uint8_t>(in.get(1));
  }
};

// What is known of a node's next object, as a context of ContextTree; docs/vmat.md numbers the questions. A trit is 1 if the
// first child sees the object, plus 2 if the second does; 0 means that there is none.
class Trits {
 public:
  static constexpr unsigned questions = 44;
  static constexpr unsigned both = 3;

  // `memory` is overwritten and must outlive this.
  Trits(const ChildBits& node, std::vector<std::uint8_t>& memory)
      : members_(node.set->members),
        history_(node.set->history),
        kind_(node.set->kind),
        last_of_kind_(memory) {
    memory.assign(members_.size(), 0);
    constexpr std::array<std::uint32_t, 5> sizes = {2, 4, 8, 32, 128};
    for (unsigned i = 0; i < sizes.size(); ++i) of_node_ |= std::uint64_t{node.leafs <= sizes[i]} << (38 + i);
    of_node_ |= std::uint64_t{node.first_child} << 43;
  }

  // Of object `at_`, the next one.
  std::uint64_t context() const {
    const std::size_t p = at_, count = members_.size();
    const std::uint32_t id = members_[p], history = history_[p], kind = kind_[p];
    std::uint64_t word = of_node_ | of_shares_;
    if (p > 0) {
      const std::uint32_t back = id - members_[p - 1];
      if (back == 1) word |= last_;
      if (back == 2) word |= last_ << 2;
      if (p > 1 && id - members_[p - 2] == 2) word |= before_last_ << 2;
      word |= std::uint64_t{((history ^ history_[p - 1]) & 15) == 0} << 26 |
              std::uint64_t{kind == kind_[p - 1]} << 27;
    }
    if (p + 1 < count) {
      const std::uint32_t on = members_[p + 1] - id;
      word |= std::uint64_t{on == 1} << 4;
      word |= std::uint64_t{on == 2 || (p + 2 < count && members_[p + 2] - id == 2)} << 5;
    }
    word |= last_ << 6 | before_last_ << 8 | std::uint64_t{history & 15} << 10;
    for (unsigned i = 0; i < 5; ++i)
      word |= std::uint64_t{last_of_history_[place(history, i)]} << (14 + 2 * i);
    word |= std::uint64_t{last_of_kind_[kind]} << 24;
    word |= std::uint64_t{repeated_ >= 4} << 28 | std::uint64_t{repeated_ >= 16} << 29;
    return word;
  }
  void next(unsigned trit) {
    const std::uint32_t history = history_[at_];
    for (unsigned i = 0; i < 5; ++i) last_of_history_[place(history, i)] = static_cast<std::uint8_t>(trit);
    last_of_kind_[kind_[at_]] = static_cast<std::uint8_t>(trit);
    repeated_ = trit == last_ ? repeated_ + 1 : 0;
    before_last_ = last_;
    last_ = trit;
    ++seen_[trit];
    ++at_;
    const std::uint64_t a = seen_[1], b = seen_[2], c = seen_[3], all = at_;
    of_shares_ = std::uint64_t{2 * c > all} << 30 | std::uint64_t{4 * c > 3 * all} << 31 |
                 std::uint64_t{8 * c > 7 * all} << 32 | std::uint64_t{32 * c > 31 * all} << 33 |
                 std::uint64_t{4 * c < all} << 34 | std::uint64_t{a > b} << 35 |
                 std::uint64_t{a > 3 * b} << 36 | std::uint64_t{b > 3 * a} << 37;
  }

 private:
  static constexpr std::array<unsigned, 5> lengths = {1, 2, 4, 6, 8};
  // One table behind the other: for each length n, the last trit of each n bits of history.
  static std::size_t place(std::uint32_t history, unsigned i) {
    constexpr std::array<std::uint32_t, 5> begin = {0, 2, 6, 22, 86};
    return begin[i] + (history & ((1u << lengths[i]) - 1));
  }
  std::span<const std::uint32_t> members_;
  std::span<const std::uint8_t> history_;
  std::span<const std::uint32_t> kind_;
  std::uint64_t of_node_ = 0, of_shares_ = 0;
  std::size_t at_ = 0;
  std::uint64_t last_ = 0, before_last_ = 0, repeated_ = 0;
  std::array<std::uint64_t, 4> seen_ = {};
  std::array<std::uint8_t, 342> last_of_history_ = {};
  std::vector<std::uint8_t>& last_of_kind_;
};

class ContextTrits : public NodeCoder {
 public:
  bool wants_history() const override { return true; }
  bool learns() const override { return true; }

  // The trees are grown from about 4 M trits, those of the nodes that a hash picks: 32 MB, and most of the time that encoding
  // takes. Each step of effort takes four times as many.
  void expect(std::uint64_t members, const EncodeOptions& options) override {
    const std::uint64_t most = std::uint64_t{1} << (22 + 2 * std::min(options.effort, 2u));
    picked_ = members <= most ? 1 : static_cast<double>(most) / static_cast<double>(members);
  }
  void see(const ChildBits& node) override {
    if (node.of_root) return;
    seen_ += node.members;
    if (picked_ < 1 && Random(node.set->node).fraction() >= picked_) return;
    learned_ += node.members;
    std::vector<std::uint8_t> memory;
    Trits trits(node, memory);
    for (std::uint32_t p = 0; p < node.members; ++p) {
      const std::uint64_t context = trits.context();
      const unsigned trit = trit_of(node, p);
      both_samples_.push_back(context | (trit == Trits::both ? ContextTree::outcome : 0));
      if (trit != Trits::both) side_samples_.push_back(context | (trit == 2 ? ContextTree::outcome : 0));
      trits.next(trit);
    }
  }
  void write_model(std::vector<std::byte>& out) override {
    const double weight = learned_ == 0 ? 1 : static_cast<double>(seen_) / static_cast<double>(learned_);
    both_ = ContextTree::grow(both_samples_, Trits::questions, weight);
    side_ = ContextTree::grow(side_samples_, Trits::questions, weight);
    both_samples_ = {};
    side_samples_ = {};
    both_.write(out);
    side_.write(out);
  }
  void read_model(ByteReader& in) override {
    both_ = ContextTree::read(in, Trits::questions);
    side_ = ContextTree::read(in, Trits::questions);
  }

  void encode(const ChildBits& node, std::vector<std::byte>& out) const override {
    if (node.of_root) {
      std::vector<std::uint32_t> ids;
      for (std::uint32_t p = 0; p < node.members; ++p) {
        if (node.bits[p] != 0) ids.push_back(p);
      }
      PairRows<GammaCode>().encode(ids, out);
      return;
    }
    RangeEncoder coder(out);
    std::vector<std::uint8_t> memory;
    Trits trits(node, memory);
    for (std::uint32_t p = 0; p < node.members; ++p) {
      const std::uint64_t context = trits.context();
      const unsigned trit = trit_of(node, p);
      coder.put_bit(trit == Trits::both, both_.share(context));
      if (trit != Trits::both) coder.put_bit(trit == 2, side_.share(context));
      trits.next(trit);
    }
    coder.finish();
  }

  void decode(std::span<const std::byte> part, ChildBits& node) const override {
    if (node.of_root) {
      RootSink sink{node.bits};
      PairRows<GammaCode>().decode(part, sink);
      if (all_ones(node.bits)) refuse_root();
      return;
    }
    RangeDecoder in(part);
    Trits trits(node, node.memory);
    for (std::uint32_t p = 0; p < node.members; ++p) {
      const std::uint64_t context = trits.context();
      const unsigned trit = in.get_bit(both_.share(context))   ? Trits::both
                            : in.get_bit(side_.share(context)) ? 2
                                                               : 1;
      node.bits[p] = trit & 1;
      node.bits[std::size_t{node.members} + p] = static_cast<std::uint8_t>(trit >> 1);
      trits.next(trit);
    }
    in.finish();
  }

 private:
  struct RootSink {
    std::span<std::uint8_t> bits;
    std::uint64_t at = 0;
    void run(std::uint64_t gap, std::uint64_t count) {
      if (gap > bits.size() - at || count > bits.size() - at - gap)
        throw FormatError("a run ends after the last object");
      std::fill_n(bits.begin() + static_cast<std::ptrdiff_t>(at + gap), count, std::uint8_t{1});
      at += gap + count;
    }
  };
  static unsigned trit_of(const ChildBits& node, std::uint32_t p) {
    return static_cast<unsigned>(node.bits[p] | node.bits[std::size_t{node.members} + p] << 1);
  }
  double picked_ = 1;
  std::uint64_t seen_ = 0, learned_ = 0;
  std::vector<std::uint64_t> both_samples_, side_samples_;
  ContextTree both_, side_;
};

template <typename Coder>
constexpr Codec method(std::string_view name, std::string_view contents, Origin origin) {
  return tree_codec<Coder, TreeOver::rows>(name, contents, origin);
}

constexpr Codec context_method() {
  Codec codec = method<ContextTrits>(
      "gotsman3-context", "of each of the node's objects which child sees it, range coded under contexts",
      Origin::ours);
  codec.slow_encode = true;
  codec.highest_effort = 2;
  return codec;
}

constexpr std::array gotsman_table = {
    method<WholeSets>("gotsman1", "both children's objects", Origin::paper),
    method<RelativeToParent>("gotsman2", "both children's objects, of the node's", Origin::paper),
    method<RelativeToSibling>(
        "gotsman3", "the first child's objects, of the node's; the second's, of the first's", Origin::paper),
    context_method(),
};

}  // namespace

std::span<const Codec> gotsman_codecs() {
  return gotsman_table;
}

}  // namespace vismat
