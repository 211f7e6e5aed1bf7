// The probability of a bit by what is known of it: a binary tree of questions, grown once for all the bits and written down.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat {

/// A context is up to 63 answers, bit f of a word being the answer to question f. Reading one probability takes as many steps
/// as the tree is deep there, 8 or so. Thread-safe once made.
class ContextTree {
 public:
  static constexpr unsigned share_bits = 14;
  static constexpr std::uint64_t outcome = std::uint64_t{1} << 63;

  /// No question, even odds.
  ContextTree() = default;
  /// For samples that are a context each and in bit `outcome` the bit to be told. A question is asked where it saves more of
  /// the samples' code, times `weight`, than its own bits and its answers' probabilities take. O(samples * questions / 64 *
  /// depth). Reorders the samples.
  static ContextTree grow(std::vector<std::uint64_t>& samples, unsigned questions, double weight = 1);
  /// From the root on, for each node: 1, its question in 6 bits, the subtree for answer 0, that for answer 1; or 0 and the
  /// probability in 8 bits. Padded to a byte.
  void write(std::vector<std::byte>& out) const;
  /// FormatError on bytes that write cannot have made: a question too high or asked twice on a way, a probability of 0.
  static ContextTree read(ByteReader& in, unsigned questions);

  /// How many of 2^14 times the outcome is 1; above 0 and below 2^14.
  std::uint32_t share(std::uint64_t context) const {
    const Node* node = nodes_.data();
    while (node->question != leaf) node = nodes_.data() + node->first + (context >> node->question & 1);
    return node->share;
  }
  std::size_t size() const { return nodes_.size(); }
  bool operator==(const ContextTree&) const = default;

 private:
  static constexpr std::uint16_t leaf = 0xffff;
  struct Node {
    std::uint16_t question = leaf, share = 1u << (share_bits - 1);
    std::uint32_t first = 0;  // the child for answer 0; that for 1 stands behind it
    bool operator==(const Node&) const = default;
  };
  struct Grower;
  std::vector<Node> nodes_ = std::vector<Node>(1);
};

}  // namespace vismat
