#include "slam/features/vocabulary.h"

#include <gtest/gtest.h>

#include <sstream>

#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

Descriptor random_descriptor(Random& random) {
  return {random.next(), random.next(), random.next(), random.next()};
}

Descriptor with_flipped_bits(Descriptor descriptor, int flips, Random& random) {
  for (int i = 0; i < flips; ++i) {
    const int bit = random.below(256);
    descriptor[static_cast<std::size_t>(bit / 64)] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

/// Places of 60 things each; an image shows a place's things with up to `flips` wrong bits.
struct World {
  std::vector<std::vector<Descriptor>> places;
  std::vector<Descriptor> image_of(std::size_t place, int flips, Random& random) const {
    std::vector<Descriptor> image;
    for (const Descriptor& thing : places[place]) {
      image.push_back(with_flipped_bits(thing, flips, random));
    }
    return image;
  }
};

World make_world(int places, Random& random) {
  World world;
  world.places.resize(static_cast<std::size_t>(places));
  for (auto& place : world.places) {
    for (int i = 0; i < 60; ++i) place.push_back(random_descriptor(random));
  }
  return world;
}

Vocabulary train_on(const World& world, Random& random) {
  std::vector<std::vector<Descriptor>> images;
  for (int round = 0; round < 3; ++round) {
    for (std::size_t p = 0; p < world.places.size(); ++p) {
      images.push_back(world.image_of(p, 12, random));
    }
  }
  VocabularyTraining training;
  training.branches = 8;
  training.depth = 4;
  training.min_descriptors = 4;
  return train_vocabulary(images, training);
}

std::string bytes_of(const Vocabulary& vocabulary) {
  std::ostringstream out;
  vocabulary.write(out);
  return out.str();
}

TEST(Vocabulary, APlaceIsMostLikeItself) {
  Random random(synthetic::seed_of("Vocabulary.APlaceIsMostLikeItself"));
  const World world = make_world(30, random);
  const Vocabulary vocabulary = train_on(world, random);
  std::vector<BagOfWords> known;
  for (std::size_t p = 0; p < world.places.size(); ++p) {
    known.push_back(vocabulary.describe(world.image_of(p, 12, random)));
  }
  for (std::size_t p = 0; p < world.places.size(); ++p) {
    const BagOfWords seen = vocabulary.describe(world.image_of(p, 12, random));
    std::size_t best = 0;
    for (std::size_t q = 0; q < known.size(); ++q) {
      if (similarity_of(seen, known[q]) > similarity_of(seen, known[best])) best = q;
    }
    EXPECT_EQ(best, p);
  }
}

TEST(Vocabulary, VectorsAreNormalisedAndScoresAreThoseOfTheL1Norm) {
  Random random(synthetic::seed_of("Vocabulary.VectorsAreNormalised"));
  const World world = make_world(10, random);
  const Vocabulary vocabulary = train_on(world, random);
  const BagOfWords a = vocabulary.describe(world.image_of(0, 12, random));
  const BagOfWords b = vocabulary.describe(world.image_of(0, 40, random));
  std::vector<double> difference(vocabulary.size(), 0.0);
  double sum = 0.0;
  for (const WeightedWord& entry : a) {
    sum += entry.weight;
    difference[static_cast<std::size_t>(entry.word)] += entry.weight;
  }
  for (const WeightedWord& entry : b) {
    difference[static_cast<std::size_t>(entry.word)] -= entry.weight;
  }
  double distance = 0.0;
  for (const double d : difference) distance += std::abs(d);
  constexpr double kFloatSum = 1e-5;  // some sixty floats
  EXPECT_NEAR(sum, 1.0, kFloatSum);
  EXPECT_NEAR(similarity_of(a, b), 1.0 - 0.5 * distance, kFloatSum);
  EXPECT_NEAR(similarity_of(a, a), 1.0, kFloatSum);
  EXPECT_TRUE(vocabulary.describe({}).empty());
}

TEST(Vocabulary, TrainingRepeatsItselfAndFilesKeepEveryBit) {
  Random random(synthetic::seed_of("Vocabulary.TrainingRepeatsItself"));
  const World world = make_world(8, random);
  Random first(7), second(7);
  const std::string bytes = bytes_of(train_on(world, first));
  EXPECT_EQ(bytes, bytes_of(train_on(world, second)));
  std::istringstream in(bytes);
  const auto back = Vocabulary::read(in);
  ASSERT_TRUE(back);
  EXPECT_EQ(bytes_of(*back), bytes);
}

TEST(Vocabulary, BrokenFilesAreRefused) {
  Random random(synthetic::seed_of("Vocabulary.BrokenFilesAreRefused"));
  const std::string bytes = bytes_of(train_on(make_world(4, random), random));
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{7}, std::size_t{12}, bytes.size() - 1}) {
    std::istringstream in(bytes.substr(0, length));
    EXPECT_FALSE(Vocabulary::read(in)) << length;
  }
  // A root that names itself as its child would never end.
  std::string cycle = bytes;
  cycle[12 + 32] = 0;
  std::istringstream in(cycle);
  EXPECT_FALSE(Vocabulary::read(in));
}

}  // namespace
}  // namespace planecast::slam
