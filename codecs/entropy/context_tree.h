// The probability of a bit in its context: a binary tree of questions, grown once for all the bits and then stored.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat {

/// A context is the answers to up to 63 questions; bit f of a word is the answer to question f. Reading one probability
/// takes as many steps as the tree is deep there, about 8. Thread-safe once made.
class ContextTree {
 public:
  static constexpr unsigned share_bits = 14;
  static constexpr std::uint64_t outcome = std::uint64_t{1} << 63;

  /// The tree without questions: even odds.
  ContextTree() = default;
  /// Grows the tree for samples. A sample is a context, with the bit to be coded in bit `outcome`. A question is asked
  /// where it saves more of the samples' code, times `weight`, than the question and its answers' probabilities take.
  /// O(samples * questions / 64 * depth). Reorders the samples.
  static ContextTree grow(std::vector<std::uint64_t>& samples, unsigned questions, double weight = 1);
  /// From the root on, for each node: a 1, its question in 6 bits, the subtree for answer 0 and that for answer 1; or a
  /// 0 and the probability in 8 bits. Padded to a byte.
  void write(std::vector<std::byte>& out) const;
  /// Throws FormatError on bytes that write cannot have made: a question too high or asked twice on a path, a
  /// probability of 0.
  static ContextTree read(ByteReader& in, unsigned questions);

  /// The probability that the outcome is 1, in units of 1 / 2^14; above 0 and below 2^14.
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
    std::uint32_t first = 0;  // the child for answer 0; the child for answer 1 is behind it
    bool operator==(const Node&) const = default;
  };
  struct Grower;
  std::vector<Node> nodes_ = std::vector<Node>(1);
};

}  // namespace vismat
