#pragma once

#include <memory>
#include <vector>

#include "slam/data/map.h"
#include "slam/features/vocabulary.h"

namespace planecast::slam {

/// Gives every keyframe that has none its bag of words.
void describe_keyframes(Map& map, const Vocabulary& vocabulary);

struct Place {
  KeyframeId keyframe = kNone;
  double score = 0.0;  ///< L1, 0..1
};

/// Scores of all keyframes that share a word with `words`, ascending by id. One pass over the
/// keyframes' words with the query laid out by word: no index to keep in step with snapshots, and a
/// thousand keyframes take about a millisecond.
std::vector<Place> score_places(const Map& map, const BagOfWords& words);

/// The `most` best scored, best first, ties by id.
std::vector<Place> best_places(std::vector<Place> places, std::size_t most);

/// Defaults [K] (Mur-Artal and Tardos, RA-L 2014).
struct PlaceOptions {
  int min_keyframes_apart = 10;
  int consistent_keyframes = 3;  ///< successive keyframes that must point at the same place
  double group_share = 0.75;     ///< of the best group's score
  int neighbours = 10;           ///< covisible keyframes that add to a group's score
};

/// Tells when a new keyframe shows a place that was mapped long before, by looks alone. One call
/// for each keyframe in turn.
class PlaceDetector {
 public:
  explicit PlaceDetector(const PlaceOptions& options) : options_(options) {}

  /// Keyframes that look like `keyframe`, better than its own covisible ones do at their worst,
  /// which are neither near it in time nor covisible, and whose neighbourhood was pointed at by the
  /// keyframes before, too. Best first. Precondition: the keyframes have their words.
  std::vector<KeyframeId> detect(const Map& map, KeyframeId keyframe);
  void reset() { groups_.clear(); }

 private:
  /// A candidate's neighbourhood and how many successive keyframes pointed at it.
  struct Group {
    std::vector<KeyframeId> members;  ///< ascending
    int seen = 1;
  };

  std::vector<Place> candidates(const Map& map, KeyframeId keyframe) const;

  PlaceOptions options_;
  std::vector<Group> groups_;  ///< of the last keyframe
};

}  // namespace planecast::slam
