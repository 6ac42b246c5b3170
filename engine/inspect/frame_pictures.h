#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "engine/inspect/session.h"
#include "engine/pipeline/frame_painter.h"
#include "engine/pipeline/scene_light.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// The pictures of a session's frames with its objects painted in. Without a sequence the pictures
/// are dark.
class FramePictures {
 public:
  /// `sequence` may be null; its frames must have the reconstruction's size.
  FramePictures(const InspectSession& session, std::unique_ptr<Sequence> sequence);

  /// The present frame's picture (CV_8UC3 BGR) with or without the objects. Kept until the frame or
  /// the content changes. A frame that cannot be read is dark.
  const cv::Mat& picture(bool with_objects);
  /// Grows with every other picture.
  int revision() const { return revision_; }
  bool has_sequence() const { return sequence_ != nullptr; }

 private:
  void read_frame();
  cv::Mat painted();

  const InspectSession& session_;
  std::unique_ptr<Sequence> sequence_;
  LightTrack light_;
  std::unique_ptr<FramePainter> painter_;
  int painter_content_ = -1;
  slam::FrameInput frame_;
  int read_position_ = -1;
  cv::Mat picture_;
  int shown_position_ = -1;
  int shown_content_ = -1;
  bool shown_objects_ = false;
  int revision_ = 0;
};

}  // namespace planecast::engine
