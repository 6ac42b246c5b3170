#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slam/features/vocabulary.h"
#include "slam/geometry/random.h"

namespace planecast::slam {
namespace {

using Members = std::vector<const Descriptor*>;

Descriptor majority_of(const Members& members) {
  std::array<int, 256> ones{};
  for (const Descriptor* member : members) {
    for (std::size_t bit = 0; bit < 256; ++bit) {
      ones[bit] += static_cast<int>(((*member)[bit / 64] >> (bit % 64)) & 1U);
    }
  }
  Descriptor centre = {};
  for (std::size_t bit = 0; bit < 256; ++bit) {
    if (2 * ones[bit] > static_cast<int>(members.size())) {
      centre[bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
  return centre;
}

/// k-means++: each further centre is drawn with the squared distance from those before.
std::vector<Descriptor> first_centres(const Members& members, int count, Random& random) {
  std::vector<Descriptor> centres = {
      *members[static_cast<std::size_t>(random.below(static_cast<int>(members.size())))]};
  std::vector<double> nearest(members.size(), 1e9);
  while (static_cast<int>(centres.size()) < count) {
    double sum = 0.0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double distance = hamming_distance(*members[i], centres.back());
      nearest[i] = std::min(nearest[i], distance * distance);
      sum += nearest[i];
    }
    if (!(sum > 0.0)) break;  // fewer different descriptors than centres
    double left = random.uniform() * sum;
    std::size_t chosen = 0;
    while (chosen + 1 < members.size() && left >= nearest[chosen]) left -= nearest[chosen++];
    centres.push_back(*members[chosen]);
  }
  return centres;
}

std::size_t nearest_centre(const std::vector<Descriptor>& centres, const Descriptor& descriptor) {
  std::size_t best = 0;
  int least = 257;
  for (std::size_t c = 0; c < centres.size(); ++c) {
    const int distance = hamming_distance(centres[c], descriptor);
    if (distance < least) {
      least = distance;
      best = c;
    }
  }
  return best;
}

struct Clusters {
  std::vector<Descriptor> centres;
  std::vector<Members> members;
};

/// Assigns all; centres that nobody is nearest to are left out.
Clusters assign(const Members& all, const std::vector<Descriptor>& centres) {
  std::vector<Members> members(centres.size());
  for (const Descriptor* descriptor : all) {
    members[nearest_centre(centres, *descriptor)].push_back(descriptor);
  }
  Clusters clusters;
  for (std::size_t c = 0; c < centres.size(); ++c) {
    if (members[c].empty()) continue;
    clusters.centres.push_back(centres[c]);
    clusters.members.push_back(std::move(members[c]));
  }
  return clusters;
}

Clusters split(const Members& all, const VocabularyTraining& training, std::uint64_t seed) {
  Random random(seed);
  Clusters clusters = assign(all, first_centres(all, training.branches, random));
  for (int round = 0; round < training.rounds; ++round) {
    std::vector<Descriptor> centres;
    for (const Members& members : clusters.members) centres.push_back(majority_of(members));
    if (centres == clusters.centres) break;
    clusters = assign(all, centres);
  }
  return clusters;
}

/// idf of every leaf from the images that hold it; a word of no image is as rare as one of one.
void set_weights(const std::vector<std::vector<Descriptor>>& images,
                 std::vector<Vocabulary::Node>& nodes) {
  const Vocabulary tree(nodes);
  std::vector<int> holders(nodes.size(), 0);
  std::vector<int> last_image(nodes.size(), -1);
  for (std::size_t image = 0; image < images.size(); ++image) {
    for (const Descriptor& descriptor : images[image]) {
      const auto word = static_cast<std::size_t>(tree.word_of(descriptor));
      if (last_image[word] == static_cast<int>(image)) continue;
      last_image[word] = static_cast<int>(image);
      ++holders[word];
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].children > 0) continue;
    nodes[i].idf =
        static_cast<float>(std::log(static_cast<double>(images.size()) / std::max(1, holders[i])));
  }
}

}  // namespace

Vocabulary train_vocabulary(const std::vector<std::vector<Descriptor>>& images,
                            const VocabularyTraining& training) {
  std::vector<Vocabulary::Node> nodes(1);
  std::vector<Members> level(1);
  for (const std::vector<Descriptor>& image : images) {
    for (const Descriptor& descriptor : image) level[0].push_back(&descriptor);
  }
  std::size_t level_begin = 0;
  for (int depth = 0; depth < training.depth; ++depth) {
    std::vector<Members> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      const std::size_t node = level_begin + i;
      if (static_cast<int>(level[i].size()) < training.min_descriptors) continue;
      Clusters clusters = split(level[i], training, mix_seed(training.seed, node));
      if (clusters.centres.size() < 2) continue;
      nodes[node].first_child = static_cast<std::int32_t>(nodes.size());
      nodes[node].children = static_cast<std::int32_t>(clusters.centres.size());
      for (std::size_t c = 0; c < clusters.centres.size(); ++c) {
        nodes.push_back({clusters.centres[c], 0, 0, 0.0F});
        next.push_back(std::move(clusters.members[c]));
      }
    }
    level_begin = nodes.size() - next.size();
    level = std::move(next);
  }
  set_weights(images, nodes);
  return Vocabulary(std::move(nodes));
}

}  // namespace planecast::slam
