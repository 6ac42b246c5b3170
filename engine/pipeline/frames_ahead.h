#pragma once

#include <future>
#include <optional>
#include <string>

#include "engine/pipeline/picture_flow.h"
#include "slam/system.h"

namespace planecast::engine {

/// Reads frames some ahead and prepares them one ahead of the one in use, on threads of their own
/// where allowed. Whether the map was initialised is known two frames late, always, so that threads
/// change nothing.
class FramesAhead {
 public:
  /// For the frames begin, begin + step, ... before end. `sequence` and `system` outlive this.
  FramesAhead(Sequence& sequence, const slam::System& system, int begin, int end, bool threaded,
              int step)
      : reader_(sequence, begin, end, threaded, step), system_(system), threaded_(threaded) {}

  struct Prepared {
    std::optional<slam::ImageFeatures> image;  ///< nothing: unreadable
    std::string error;
  };

  /// Starts on the next frame; there must be one.
  void request(bool initialised);
  /// The frame requested last; waits for it.
  Prepared take() { return next_.get(); }

 private:
  Prepared prepare(bool initialised);

  FrameReader reader_;
  const slam::System& system_;
  bool threaded_;
  std::future<Prepared> next_;
};

}  // namespace planecast::engine
