#pragma once

#include <vector>

namespace planecast::slam {

/// A visual word of an image and its share of the image's weight (tf-idf).
struct WeightedWord {
  int word = 0;
  float weight = 0.0F;
};

/// An image as a sparse vector over a vocabulary: ascending by word, weights sum up to 1. Empty
/// where the image has no features.
using BagOfWords = std::vector<WeightedWord>;

}  // namespace planecast::slam
