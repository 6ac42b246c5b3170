#pragma once

#include <filesystem>
#include <memory>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// Opens a video that FFmpeg can read. Its frames are counted by decoding them once, since what
/// containers say is an estimate; time stamps are index / fps. Throws UserError.
std::unique_ptr<Sequence> open_video(const std::filesystem::path& path,
                                     const SequenceOptions& options);

}  // namespace planecast::engine
