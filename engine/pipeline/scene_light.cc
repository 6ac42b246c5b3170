#include "engine/pipeline/scene_light.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "engine/look/exposure.h"
#include "engine/look/surroundings.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

std::vector<const FrameRecord*> sampled_frames(const Sequence& sequence,
                                               const Reconstruction& reconstruction,
                                               const LightTrackOptions& options) {
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : reconstruction.frames) {
    const bool in_range =
        frame.index >= sequence.first_frame() && frame.index < sequence.end_frame();
    const auto& pose = options.causal ? frame.causal_world_from_cam : frame.world_from_cam;
    if (pose && in_range) posed.push_back(&frame);
  }
  const auto stride = std::max<std::size_t>(
      static_cast<std::size_t>(options.stride),
      posed.size() / static_cast<std::size_t>(std::max(options.most_samples, 1)));
  std::vector<const FrameRecord*> sampled;
  for (std::size_t i = 0; i < posed.size(); i += stride) sampled.push_back(posed[i]);
  return sampled;
}

/// The pictures of some frames, in their order, each read while the one before is looked at.
class PicturesAhead {
 public:
  PicturesAhead(Sequence& sequence, const std::vector<const FrameRecord*>& frames, bool threaded)
      : sequence_(sequence), frames_(frames), threaded_(threaded) {
    read_next();
  }

  /// Throws what reading it threw.
  cv::Mat next() {
    std::future<cv::Mat> read = std::move(read_);
    read.wait();
    read_next();
    return read.get();
  }

 private:
  void read_next() {
    if (begun_ == frames_.size()) return;
    read_ = std::async(
        threaded_ ? std::launch::async : std::launch::deferred,
        [this, index = frames_[begun_++]->index] { return sequence_.read(index).image; });
  }

  Sequence& sequence_;
  const std::vector<const FrameRecord*>& frames_;
  bool threaded_;
  std::size_t begun_ = 0;
  std::future<cv::Mat> read_;
};

SceneLight scaled(SceneLight light, double gain) {
  light.mean *= gain;
  light.sun_radiance *= gain;
  light.exposure *= gain;
  return light;
}

}  // namespace

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

SceneLight between(const SceneLight& from, const SceneLight& to, double t) {
  SceneLight light;
  light.mean = (1.0 - t) * from.mean + t * to.mean;
  light.gradient = (1.0 - t) * from.gradient + t * to.gradient;
  light.sun_radiance = (1.0 - t) * from.sun_radiance + t * to.sun_radiance;
  const Eigen::Vector3d direction = (1.0 - t) * from.sun_direction + t * to.sun_direction;
  light.sun_direction =
      direction.norm() > 1e-6 ? Eigen::Vector3d(direction.normalized()) : to.sun_direction;
  return light;
}

LightTrack::LightTrack(Sequence& sequence, const Reconstruction& reconstruction,
                       const std::optional<FixedLight>& fixed, const LightTrackOptions& options)
    : causal_(options.causal) {
  LightEstimator estimator;
  without_samples_ =
      fixed ? fixed_light(*fixed, reconstruction.up) : estimator.estimate(reconstruction.up);
  if (fixed && !options.follow_exposure) return;
  const bool reflections = options.reflections && !options.causal && !fixed;
  Surroundings surroundings;
  const auto frames = sampled_frames(sequence, reconstruction, options);
  const std::size_t view_step =
      std::max<std::size_t>(1, frames.size() / static_cast<std::size_t>(options.most_views));
  PicturesAhead pictures(sequence, frames, options.threads > 1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameRecord& frame = *frames[i];
    const slam::Pose& pose = options.causal ? *frame.causal_world_from_cam : *frame.world_from_cam;
    Sample sample;
    sample.frame_index = frame.index;
    try {
      const cv::Mat image = pictures.next();
      if (options.follow_exposure) sample.gain = exposure_gain(reconstruction, image, pose);
      if (!fixed && i % view_step == 0) estimator.add(image, reconstruction.camera, pose);
      if (reflections) surroundings.add(image, reconstruction.camera, pose, sample.gain);
    } catch (const UserError&) {
      continue;  // the render pass reports it
    }
    sample.light = without_samples_;
    if (!fixed && options.causal) {
      sample.light = i % view_step == 0 || samples_.empty() ? estimator.estimate(reconstruction.up)
                                                            : samples_.back().light;
    }
    samples_.push_back(sample);
  }
  if (!fixed && !options.causal) {
    const SceneLight light = estimator.estimate(reconstruction.up);
    for (Sample& sample : samples_) sample.light = light;
    if (reflections && surroundings.seen() > 0.0) {
      render::EnvironmentOptions environment_options;
      environment_options.threads = options.threads;
      environment_ =
          std::make_shared<render::Environment>(surroundings.panorama(light), environment_options);
    }
  }
  if (options.causal) {
    filter(options.causal_share);
  } else {
    smooth_exposure(options.smooth_samples);
  }
}

/// Gaussian over the neighbours, in the logarithm: a gain and its inverse weigh the same.
void LightTrack::smooth_exposure(double deviation) {
  const auto reach = static_cast<int>(std::ceil(3.0 * deviation));
  std::vector<double> smooth;
  const auto count = static_cast<int>(samples_.size());
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    double weights = 0.0;
    for (int k = std::max(0, i - reach); k <= std::min(count - 1, i + reach); ++k) {
      const double d = (k - i) / std::max(deviation, 1e-9);
      const double weight = std::exp(-0.5 * d * d);
      sum += weight * std::log(samples_[static_cast<std::size_t>(k)].gain);
      weights += weight;
    }
    smooth.push_back(std::exp(sum / weights));
  }
  for (int i = 0; i < count; ++i) {
    samples_[static_cast<std::size_t>(i)].gain = smooth[static_cast<std::size_t>(i)];
  }
}

/// Each sample a share of itself and the rest of what was before.
void LightTrack::filter(double share) {
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    samples_[i].gain = (1.0 - share) * samples_[i - 1].gain + share * samples_[i].gain;
    samples_[i].light = between(samples_[i - 1].light, samples_[i].light, share);
  }
}

SceneLight LightTrack::at(int frame_index) const {
  if (samples_.empty()) return without_samples_;
  const auto later = std::ranges::upper_bound(samples_, frame_index, {}, &Sample::frame_index);
  if (later == samples_.begin()) return scaled(later->light, later->gain);
  const auto now = later - 1;
  if (!causal_) {
    if (later == samples_.end()) return scaled(now->light, now->gain);
    const double t = static_cast<double>(frame_index - now->frame_index) /
                     (later->frame_index - now->frame_index);
    return scaled(between(now->light, later->light, t), (1.0 - t) * now->gain + t * later->gain);
  }
  // What the latest sample says comes in over as many frames as lie between the last two.
  if (now == samples_.begin()) return scaled(now->light, now->gain);
  const auto before = now - 1;
  const double t = std::min(
      1.0, (frame_index - now->frame_index + 1.0) / (now->frame_index - before->frame_index));
  return scaled(between(before->light, now->light, t), (1.0 - t) * before->gain + t * now->gain);
}

}  // namespace planecast::engine
