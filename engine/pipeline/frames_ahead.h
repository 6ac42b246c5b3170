#pragma once

#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "engine/pipeline/ordered_queue.h"
#include "engine/pipeline/picture_flow.h"
#include "slam/system.h"

namespace planecast::engine {

/// Reads frames some ahead and prepares those that were requested, in order, on threads of their
/// own where allowed. What preparing depends on comes with the request, so that threads change
/// nothing.
class FramesAhead {
 public:
  /// For the frames begin, begin + step, ... before end. `sequence` and `system` outlive this.
  FramesAhead(Sequence& sequence, const slam::System& system, int begin, int end, bool threaded,
              int step);
  ~FramesAhead();
  FramesAhead(const FramesAhead&) = delete;
  FramesAhead& operator=(const FramesAhead&) = delete;

  /// As many may be requested and not yet taken.
  static constexpr int kMost = 4;

  struct Prepared {
    std::optional<slam::ImageFeatures> image;  ///< nothing: unreadable
    std::string error;
  };

  /// Asks for the next frame; there must be one.
  void request(bool initialised);
  /// The oldest frame that was requested; waits for it. Throws what preparing it threw.
  Prepared take();

 private:
  struct Outcome {
    Prepared prepared;
    std::exception_ptr failure;
  };

  Outcome prepare(bool initialised);
  void prepare_all();

  FrameReader reader_;
  const slam::System& system_;
  OrderedQueue<bool> requests_;  ///< whether the map is initialised
  OrderedQueue<Outcome> outcomes_;
  std::thread thread_;  ///< none: take() prepares
};

}  // namespace planecast::engine
