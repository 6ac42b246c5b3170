#pragma once

#include <future>
#include <optional>
#include <string>

#include "engine/sequence/sequence.h"
#include "slam/system.h"

namespace planecast::engine {

/// Reads and prepares frames one ahead of the one in use, on a second thread where allowed. Whether
/// the map was initialised is known two frames late, always, so that threads change nothing.
class FramesAhead {
 public:
  /// `sequence` and `system` outlive this.
  FramesAhead(Sequence& sequence, const slam::System& system, bool threaded)
      : sequence_(sequence), system_(system), threaded_(threaded) {}

  struct Prepared {
    std::optional<slam::ImageFeatures> image;  ///< nothing: unreadable
    std::string error;
  };

  /// Starts on the frame of the sequence with this index.
  void request(int index, bool initialised);
  /// The frame requested last; waits for it.
  Prepared take() { return next_.get(); }

 private:
  Prepared prepare(int index, bool initialised) const;

  Sequence& sequence_;
  const slam::System& system_;
  bool threaded_;
  std::future<Prepared> next_;
};

}  // namespace planecast::engine
