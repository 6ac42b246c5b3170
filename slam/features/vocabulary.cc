#include "slam/features/vocabulary.h"

#include <algorithm>
#include <cmath>
#include <istream>
#include <iterator>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "slam/data/byte_stream.h"

namespace planecast::slam {
namespace {

constexpr char kMagic[8] = {'P', 'L', 'N', 'C', 'V', 'O', 'C', 1};
constexpr std::size_t kNodeBytes = sizeof(Descriptor) + 2 * sizeof(std::int32_t) + sizeof(float);

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
  ByteWriter writer;
  writer.put(static_cast<std::uint32_t>(nodes_.size()));
  for (const Node& node : nodes_) {
    for (const std::uint64_t bits : node.centre) writer.put(bits);
    writer.put(node.first_child);
    writer.put(node.children);
    writer.put(node.idf);
  }
  out.write(kMagic, sizeof(kMagic));
  out << writer.bytes();
}

std::optional<Vocabulary> Vocabulary::read(std::istream& in) {
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  ByteReader reader(bytes);
  if (reader.take(sizeof(kMagic)) != std::string_view(kMagic, sizeof(kMagic))) return std::nullopt;
  const auto count = reader.number<std::uint32_t>();
  if (!reader.ok() || count > reader.rest().size() / kNodeBytes) return std::nullopt;
  std::vector<Node> nodes(count);
  for (Node& node : nodes) {
    for (std::uint64_t& bits : node.centre) bits = reader.number<std::uint64_t>();
    node.first_child = reader.number<std::int32_t>();
    node.children = reader.number<std::int32_t>();
    node.idf = reader.number<float>();
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
