#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"

namespace planecast::engine {

struct SequenceOptions {
  std::string camera;  ///< preset name or file; empty: camera.yaml in the folder, else a guess
  std::optional<cv::Size> size;  ///< resize the frames (the intrinsics follow)
  int first_frame = 0;           ///< --frames A:B, 0-based
  int end_frame = -1;            ///< excluded; -1 = to the end
};

/// World-from-camera pose with its time.
struct TimedPose {
  double timestamp = 0.0;
  slam::Pose world_from_cam = slam::Pose::Identity();
};

/// A recorded sequence, read frame by frame. Frame indices are those of the whole sequence.
class Sequence {
 public:
  virtual ~Sequence() = default;
  virtual int first_frame() const = 0;
  virtual int end_frame() const = 0;  ///< excluded
  /// Seconds. May be known only after the frame was read for a video.
  virtual double timestamp(int index) const = 0;
  /// Decodes frame `index`; throws UserError naming the file when it cannot be decoded. Sequential
  /// access is fast for every kind of input; going back is allowed.
  virtual slam::FrameInput read(int index) = 0;
  virtual bool has_depth() const = 0;
  virtual bool has_labels() const = 0;
  virtual const slam::Camera& camera() const = 0;
  virtual double fps() const = 0;  ///< for the output video: median of the time differences
  virtual std::string name() const = 0;
  virtual std::filesystem::path path() const = 0;
  virtual const std::vector<std::string>& warnings() const = 0;  ///< to be shown once
};

/// TUM-format folder, image folder or video file, found out by looking. Throws UserError.
std::unique_ptr<Sequence> open_sequence(const std::filesystem::path& path,
                                        const SequenceOptions& options);

}  // namespace planecast::engine
