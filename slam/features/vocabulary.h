#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <vector>

#include "slam/data/bag_of_words.h"
#include "slam/data/frame.h"

namespace planecast::slam {

/// A tree of visual words over 256-bit descriptors (Nister and Stewenius, CVPR 2006, in its binary
/// form: Galvez-Lopez and Tardos, T-RO 2012). A descriptor goes down to the nearest child until it
/// reaches a leaf, its word.
class Vocabulary {
 public:
  /// Children of a node lie side by side; a leaf has none.
  struct Node {
    Descriptor centre = {};
    std::int32_t first_child = 0;
    std::int32_t children = 0;
    float idf = 0.0F;  ///< leaves: ln(images / images with this word)
  };

  Vocabulary() = default;
  /// `nodes` breadth first from the root, every child after its parent.
  explicit Vocabulary(std::vector<Node> nodes) : nodes_(std::move(nodes)) {}

  /// Word of a descriptor: the index of its leaf.
  int word_of(const Descriptor& descriptor) const;
  /// tf-idf vector of an image, L1-normalised.
  BagOfWords describe(const std::vector<Descriptor>& descriptors) const;

  int words() const;
  std::size_t size() const { return nodes_.size(); }
  const std::vector<Node>& nodes() const { return nodes_; }
  bool empty() const { return nodes_.empty(); }

  /// Layout, little endian: 8 bytes "PLNCVOC" 1, uint32 nodes, then per node 4 x uint64 centre,
  /// int32 first child, int32 children, float idf.
  void write(std::ostream& out) const;
  /// Nothing where the stream does not hold a whole and sound vocabulary.
  static std::optional<Vocabulary> read(std::istream& in);

 private:
  std::vector<Node> nodes_;
};

/// 1 - |a - b|_1 / 2 of two normalised vectors: 1 for equal ones, 0 without a common word.
double similarity_of(const BagOfWords& a, const BagOfWords& b);

struct VocabularyTraining {
  int branches = 10;
  int depth = 5;             ///< levels below the root
  int rounds = 10;           ///< of k-majority at a node
  int min_descriptors = 20;  ///< a node with fewer becomes a leaf
  std::uint64_t seed = 1;
};

/// Hierarchical k-majority: k-means in Hamming space, where a centre's bit is its members'
/// majority, started as in k-means++ (Arthur and Vassilvitskii, SODA 2007). Seeded; the same tree
/// for the same images. Precondition: there is a descriptor.
Vocabulary train_vocabulary(const std::vector<std::vector<Descriptor>>& images,
                            const VocabularyTraining& training);

}  // namespace planecast::slam
