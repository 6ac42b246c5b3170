#pragma once

#include <filesystem>

#include "engine/pipeline/track_sequence.h"

namespace planecast::engine {

/// Writes the reconstruction folder, and last `resume.txt`, which says what it was made from:
/// program, sequence, options. Where that file stands everything is complete and of one run. A
/// reconstruction that ends before the sequence gets none; one that was interrupted before its
/// first frame is not written at all but Cancelled, as it would take the place of what an earlier
/// run left.
void write_tracked(const Reconstruction& reconstruction, const Sequence& sequence,
                   const TrackSequenceOptions& options, const std::filesystem::path& folder);
/// Whether the folder holds the complete reconstruction that tracking would make again.
bool is_tracked(const Sequence& sequence, const TrackSequenceOptions& options,
                const std::filesystem::path& folder);

}  // namespace planecast::engine
