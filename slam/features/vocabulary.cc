#include "slam/features/vocabulary.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <istream>
#include <ostream>
#include <string>

namespace planecast::slam {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are dumped as they lie in memory");

constexpr char kMagic[8] = {'P', 'L', 'N', 'C', 'V', 'O', 'C', 1};
constexpr std::uint32_t kMostNodes = 1U << 24;

template <typename T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <typename T>
bool take(std::istream& in, T& value) {
  return static_cast<bool>(in.read(reinterpret_cast<char*>(&value), sizeof(T)));
}

/// Every child lies behind its parent and within the tree, so that any descent ends.
bool is_sound(const std::vector<Vocabulary::Node>& nodes) {
  const auto size = static_cast<std::int64_t>(nodes.size());
  for (std::int64_t i = 0; i < size; ++i) {
    const Vocabulary::Node& node = nodes[static_cast<std::size_t>(i)];
    if (!std::isfinite(node.idf) || node.idf < 0.0F || node.children < 0) return false;
    if (node.children == 0) continue;
    if (node.first_child <= i) return false;
    if (static_cast<std::int64_t>(node.first_child) + node.children > size) return false;
  }
  return size > 0;
}

}  // namespace

int Vocabulary::word_of(const Descriptor& descriptor) const {
  int index = 0;
  while (nodes_[static_cast<std::size_t>(index)].children > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    int nearest = node.first_child;
    int least = 257;
    for (int child = node.first_child; child < node.first_child + node.children; ++child) {
      const int distance =
          hamming_distance(descriptor, nodes_[static_cast<std::size_t>(child)].centre);
      if (distance < least) {
        least = distance;
        nearest = child;
      }
    }
    index = nearest;
  }
  return index;
}

BagOfWords Vocabulary::describe(const std::vector<Descriptor>& descriptors) const {
  BagOfWords bag;
  if (nodes_.empty()) return bag;
  std::vector<int> words;
  words.reserve(descriptors.size());
  for (const Descriptor& descriptor : descriptors) words.push_back(word_of(descriptor));
  std::sort(words.begin(), words.end());
  double sum = 0.0;
  for (const int word : words) {
    const float idf = nodes_[static_cast<std::size_t>(word)].idf;
    if (bag.empty() || bag.back().word != word) bag.push_back({word, 0.0F});
    bag.back().weight += idf;
    sum += idf;
  }
  std::erase_if(bag, [](const WeightedWord& entry) { return !(entry.weight > 0.0F); });
  for (WeightedWord& entry : bag) entry.weight = static_cast<float>(entry.weight / sum);
  return bag;
}

int Vocabulary::words() const {
  return static_cast<int>(std::count_if(nodes_.begin(), nodes_.end(),
                                        [](const Node& node) { return node.children == 0; }));
}

void Vocabulary::write(std::ostream& out) const {
  out.write(kMagic, sizeof(kMagic));
  put(out, static_cast<std::uint32_t>(nodes_.size()));
  for (const Node& node : nodes_) {
    put(out, node.centre);
    put(out, node.first_child);
    put(out, node.children);
    put(out, node.idf);
  }
}

std::optional<Vocabulary> Vocabulary::read(std::istream& in) {
  char magic[sizeof(kMagic)];
  std::uint32_t count = 0;
  if (!in.read(magic, sizeof(magic)) || std::memcmp(magic, kMagic, sizeof(magic)) != 0 ||
      !take(in, count) || count > kMostNodes) {
    return std::nullopt;
  }
  std::vector<Node> nodes;
  for (std::uint32_t i = 0; i < count; ++i) {
    Node node;
    if (!take(in, node.centre) || !take(in, node.first_child) || !take(in, node.children) ||
        !take(in, node.idf)) {
      return std::nullopt;
    }
    nodes.push_back(node);
  }
  if (!is_sound(nodes)) return std::nullopt;
  return Vocabulary(std::move(nodes));
}

double similarity_of(const BagOfWords& a, const BagOfWords& b) {
  double common = 0.0;
  auto in_a = a.begin();
  auto in_b = b.begin();
  while (in_a != a.end() && in_b != b.end()) {
    if (in_a->word < in_b->word) {
      ++in_a;
    } else if (in_b->word < in_a->word) {
      ++in_b;
    } else {
      common += std::min(in_a->weight, in_b->weight);
      ++in_a;
      ++in_b;
    }
  }
  return common;
}

}  // namespace planecast::slam
