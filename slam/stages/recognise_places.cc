#include "slam/stages/recognise_places.h"

#include <algorithm>

namespace planecast::slam {
namespace {

std::vector<KeyframeId> neighbourhood(const Map& map, KeyframeId keyframe) {
  std::vector<KeyframeId> members = {keyframe};
  for (const auto& [id, shared] : map.covisible(keyframe)) members.push_back(id);
  std::sort(members.begin(), members.end());
  return members;
}

bool overlap(const std::vector<KeyframeId>& a, const std::vector<KeyframeId>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&b](KeyframeId id) { return std::binary_search(b.begin(), b.end(), id); });
}

}  // namespace

void describe_keyframes(Map& map, const Vocabulary& vocabulary) {
  for (Keyframe& keyframe : map.keyframes) {
    if (keyframe.words != nullptr) continue;
    keyframe.words =
        std::make_shared<const BagOfWords>(vocabulary.describe(keyframe.features->descriptors));
  }
}

std::vector<Place> score_places(const Map& map, const BagOfWords& words) {
  std::vector<Place> places;
  if (words.empty()) return places;
  std::vector<float> query(static_cast<std::size_t>(words.back().word) + 1, 0.0F);
  for (const WeightedWord& entry : words)
    query[static_cast<std::size_t>(entry.word)] = entry.weight;
  for (const Keyframe& keyframe : map.keyframes) {
    if (keyframe.words == nullptr) continue;
    double score = 0.0;
    for (const WeightedWord& entry : *keyframe.words) {
      if (static_cast<std::size_t>(entry.word) >= query.size()) break;
      score += std::min(entry.weight, query[static_cast<std::size_t>(entry.word)]);
    }
    if (score > 0.0) places.push_back({keyframe.id, score});
  }
  return places;
}

std::vector<Place> best_places(std::vector<Place> places, std::size_t most) {
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.score > b.score; });
  if (places.size() > most) places.resize(most);
  return places;
}

std::vector<Place> PlaceDetector::candidates(const Map& map, KeyframeId keyframe) const {
  std::vector<double> score(static_cast<std::size_t>(map.keyframes.next_id()), 0.0);
  for (const Place& place : score_places(map, *map.keyframes.at(keyframe).words)) {
    score[static_cast<std::size_t>(place.keyframe)] = place.score;
  }
  std::vector<char> excluded(score.size(), 0);
  excluded[static_cast<std::size_t>(keyframe)] = 1;
  double worst_covisible = 1.0;
  for (const auto& [id, shared] : map.covisible(keyframe)) {
    excluded[static_cast<std::size_t>(id)] = 1;
    worst_covisible = std::min(worst_covisible, score[static_cast<std::size_t>(id)]);
  }
  const auto eligible = [&](KeyframeId id) {
    return excluded[static_cast<std::size_t>(id)] == 0 &&
           keyframe - id >= options_.min_keyframes_apart &&
           score[static_cast<std::size_t>(id)] >= worst_covisible;
  };
  std::vector<Place> groups;
  double best_group = 0.0;
  for (const Keyframe& candidate : map.keyframes) {
    if (!eligible(candidate.id)) continue;
    Place group{candidate.id, score[static_cast<std::size_t>(candidate.id)]};
    int added = 0;
    for (const auto& [id, shared] : map.covisible(candidate.id)) {
      if (added++ == options_.neighbours) break;
      if (eligible(id)) group.score += score[static_cast<std::size_t>(id)];
    }
    best_group = std::max(best_group, group.score);
    groups.push_back(group);
  }
  std::erase_if(
      groups, [&](const Place& group) { return group.score < options_.group_share * best_group; });
  for (Place& group : groups) group.score = score[static_cast<std::size_t>(group.keyframe)];
  return best_places(std::move(groups), static_cast<std::size_t>(options_.neighbours));
}

std::vector<KeyframeId> PlaceDetector::detect(const Map& map, KeyframeId keyframe) {
  std::vector<KeyframeId> found;
  std::vector<Group> groups;
  for (const Place& place : candidates(map, keyframe)) {
    Group group{neighbourhood(map, place.keyframe), 1};
    for (const Group& before : groups_) {
      if (overlap(group.members, before.members))
        group.seen = std::max(group.seen, before.seen + 1);
    }
    if (group.seen >= options_.consistent_keyframes) found.push_back(place.keyframe);
    groups.push_back(std::move(group));
  }
  groups_ = std::move(groups);
  return found;
}

}  // namespace planecast::slam
