#pragma once

#include <memory>

#include "engine/pipeline/track_sequence.h"
#include "engine/sequence/sequence.h"
#include "slam/segmentation/plane_segmenter.h"
#include "slam/system.h"

namespace planecast::engine {

/// Whether depth is used, by options.mode; throws UserError where there is none, and for other
/// words.
bool use_depth(const Sequence& sequence, const TrackSequenceOptions& options);

/// Throws UserError for words that are no option, and for a broken vocabulary.
slam::SystemOptions system_options(const TrackSequenceOptions& options, bool rgbd);

/// What masks come from, made to leak where the options ask for it.
std::unique_ptr<slam::PlaneSegmenter> make_segmenter(const Sequence& sequence, bool rgbd,
                                                     const TrackSequenceOptions& options);

}  // namespace planecast::engine
