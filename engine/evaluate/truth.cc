#include "engine/evaluate/truth.h"

#include "engine/evaluate/visibility.h"
#include "engine/output/planes_json.h"
#include "engine/sequence/groundtruth.h"

namespace planecast::engine {
namespace {

/// Poses this long before the first and after the last frame still belong to them.
constexpr double kMargin_s = 0.02;

std::vector<TimedPose> within_frames(const std::vector<TimedPose>& poses,
                                     const Sequence& sequence) {
  const double first = sequence.timestamp(sequence.first_frame()) - kMargin_s;
  const double last = sequence.timestamp(sequence.end_frame() - 1) + kMargin_s;
  std::vector<TimedPose> kept;
  for (const TimedPose& pose : poses) {
    if (pose.timestamp >= first && pose.timestamp <= last) kept.push_back(pose);
  }
  return kept;
}

}  // namespace

SequenceTruth read_sequence_truth(const std::filesystem::path& path, const SequenceOptions& options,
                                  const std::filesystem::path& groundtruth) {
  const std::unique_ptr<Sequence> sequence = open_sequence(path, options);
  SequenceTruth truth;
  truth.camera = sequence->camera();
  truth.poses = within_frames(
      read_groundtruth(groundtruth.empty() ? path : groundtruth, sequence->fps()), *sequence);
  if (std::filesystem::exists(path / "planes.json")) {
    truth.planes = read_planes_json(path / "planes.json").planes;
    if (sequence->has_labels()) truth.seen_labels = labels_in_view(*sequence);
  }
  return truth;
}

}  // namespace planecast::engine
