#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/look/light.h"
#include "engine/pipeline/reconstruction.h"
#include "engine/scene/scene_file.h"
#include "engine/sequence/sequence.h"
#include "render/environment.h"

namespace planecast::engine {

/// The scene file's sun and sky in the world: y up, x to the right of the world's (first
/// keyframe's) camera, z towards its viewer.
SceneLight fixed_light(const FixedLight& light, const Eigen::Vector3d& up);

struct LightTrackOptions {
  bool causal = false;          ///< from what was seen up to each frame alone
  bool follow_exposure = true;  ///< brightness follows the pictures'
  bool reflections = false;     ///< what the camera saw of the room is kept; not causal
  int stride = 6;               ///< frames from one sample to the next, at least
  int most_samples = 100;
  int most_views = 24;          ///< samples that the surroundings are estimated from
  double smooth_samples = 1.0;  ///< standard deviation of the exposure's smoothing
  double causal_share = 0.5;    ///< of a new sample in the causal filter
  int threads = 1;              ///< changes no result
};

/// The light over the frames of a sequence: the surroundings and the main direction as all pictures
/// together show them, and the exposure of each time. Looking back and ahead, it is smoothed over
/// the samples and read between them, so that nothing flickers; causal, every sample reaches the
/// content over the frames that follow it, and the direction settles as more is seen. A frame's
/// light depends on the samples alone, never on which frames were drawn before it.
class LightTrack {
 public:
  /// Reads the samples' pictures; those that cannot be read are passed over.
  LightTrack(Sequence& sequence, const Reconstruction& reconstruction,
             const std::optional<FixedLight>& fixed, const LightTrackOptions& options = {});

  /// The same light in every frame.
  explicit LightTrack(const SceneLight& light) : without_samples_(light) {}

  SceneLight at(int frame_index) const;
  /// What polished things reflect, at exposure 1; null when it was not wanted or not seen.
  const std::shared_ptr<const render::Environment>& environment() const { return environment_; }

 private:
  struct Sample {
    int frame_index = 0;
    double gain = 1.0;  ///< of the exposure
    SceneLight light;
  };
  void smooth_exposure(double deviation);
  void filter(double share);

  bool causal_ = false;
  SceneLight without_samples_;
  std::shared_ptr<const render::Environment> environment_;
  std::vector<Sample> samples_;  ///< ascending
};

/// `t` of the way from one light to another.
SceneLight between(const SceneLight& from, const SceneLight& to, double t);

}  // namespace planecast::engine
