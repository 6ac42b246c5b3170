#include "engine/evaluate/training_rooms.h"

#include "engine/sequence/synth/training_picture.h"

namespace planecast::engine {

MaskResult evaluate_on_rooms(slam::PlaneSegmenter& segmenter, std::uint64_t first, int rooms) {
  synth::TileBank bank(first);  // its textures are in no training set either
  MaskSums sums;
  for (int i = 0; i < rooms; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const synth::TrainingRoom room = synth::make_training_room(seed, bank);
    const synth::TrainingSample sample =
        synth::TrainingPainter(room, bank, seed).draw(synth::view_seed(seed, 0));
    slam::FrameInput frame;
    frame.image = sample.bgr;
    sums.add(score_masks(segmenter.segment(frame), synth::asked_labels(sample.labels)));
  }
  return sums.result();
}

}  // namespace planecast::engine
