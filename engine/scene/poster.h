#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "engine/scene/scene_file.h"
#include "engine/sequence/sequence.h"
#include "render/gltf/model.h"

namespace planecast::engine {

/// A picture or a video as a flat print: a thin board one unit wide and as high as the picture's
/// shape says, its back on z = 0, the picture on its front, the edges white.
class PosterPrint {
 public:
  /// Throws UserError naming the file where it cannot be read.
  explicit PosterPrint(const Poster& poster);

  /// The print as it looks `time_s` after its start: for a video the frame of that time, which is
  /// decoded, over and over again or (without `loop`) until the last one stays. The same frame is
  /// the same object while it is among the latest few. Several threads may ask.
  std::shared_ptr<const render::Model> at(double time_s, bool loop);
  double height() const { return height_; }

 private:
  /// Painting threads are a few frames apart.
  static constexpr std::size_t kKept = 8;
  struct Shown {
    int frame = 0;
    std::shared_ptr<const render::Model> model;
  };

  std::mutex mutex_;                 ///< of the video and what it shows
  std::unique_ptr<Sequence> video_;  ///< null: a picture
  double height_ = 1.0;
  std::deque<Shown> shown_;  ///< a picture's only one, or a video's latest
};

}  // namespace planecast::engine
