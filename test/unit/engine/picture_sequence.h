#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// A sequence of pictures that a function makes, without files.
class PictureSequence : public Sequence {
 public:
  using Draw = std::function<slam::FrameInput(int index)>;
  PictureSequence(const slam::Camera& camera, int first, int end, Draw draw)
      : camera_(camera), first_(first), end_(end), draw_(std::move(draw)) {}

  int first_frame() const override { return first_; }
  int end_frame() const override { return end_; }
  double timestamp(int index) const override { return index / 30.0; }
  slam::FrameInput read(int index) override {
    slam::FrameInput frame = draw_(index);
    frame.index = index;
    frame.timestamp = timestamp(index);
    return frame;
  }
  bool has_depth() const override { return false; }
  bool has_labels() const override { return false; }
  const slam::Camera& camera() const override { return camera_; }
  double fps() const override { return 30.0; }
  std::string name() const override { return "pictures"; }
  std::filesystem::path path() const override { return "pictures"; }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  slam::Camera camera_;
  int first_;
  int end_;
  Draw draw_;
  std::vector<std::string> warnings_;
};

}  // namespace planecast::engine
