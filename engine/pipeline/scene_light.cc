#include "engine/pipeline/scene_light.h"

#include <vector>

#include "engine/user_error.h"

namespace planecast::engine {

SceneLight fixed_light(const FixedLight& light, const Eigen::Vector3d& up) {
  Eigen::Vector3d right = Eigen::Vector3d::UnitX() - up.x() * up;
  right = right.norm() > 1e-6 ? Eigen::Vector3d(right.normalized()) : up.unitOrthogonal();
  const Eigen::Vector3d& d = light.sun_direction;
  SceneLight result;
  result.mean = light.sky_radiance;
  result.gradient.setZero();
  result.sun_direction = (d.x() * right + d.y() * up + d.z() * right.cross(up)).normalized();
  result.sun_radiance = light.sun_radiance;
  return result;
}

SceneLight estimate_light(Sequence& sequence, const Reconstruction& reconstruction, int samples) {
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : reconstruction.frames) {
    const bool in_range =
        frame.index >= sequence.first_frame() && frame.index < sequence.end_frame();
    if (frame.world_from_cam && in_range) posed.push_back(&frame);
  }
  LightEstimator estimator;
  const std::size_t count = std::min(posed.size(), static_cast<std::size_t>(samples));
  for (std::size_t i = 0; i < count; ++i) {
    const FrameRecord& frame = *posed[(2 * i + 1) * posed.size() / (2 * count)];
    try {
      estimator.add(sequence.read(frame.index).image, reconstruction.camera, *frame.world_from_cam);
    } catch (const UserError&) {
      continue;  // the render pass reports it
    }
  }
  return estimator.estimate(reconstruction.up);
}

}  // namespace planecast::engine
