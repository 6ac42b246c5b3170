#include "engine/sequence/image_list_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/sequence/frame_setup.h"
#include "engine/sequence/image_file.h"
#include "engine/sequence/numbered_frames.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

constexpr double kDefaultFps = 30.0;

double median_fps(const std::vector<FrameFiles>& frames, double fallback) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    steps.push_back(frames[i].timestamp - frames[i - 1].timestamp);
  }
  if (steps.empty()) return fallback;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle > 0.0 ? 1.0 / *middle : fallback;
}

bool any(const std::vector<FrameFiles>& frames, fs::path FrameFiles::*member) {
  return std::any_of(frames.begin(), frames.end(),
                     [member](const FrameFiles& frame) { return !(frame.*member).empty(); });
}

class ImageListSequence : public Sequence {
 public:
  ImageListSequence(ImageList list, const SequenceOptions& options)
      : list_(std::move(list)),
        range_(select_frames(options, static_cast<int>(list_.frames.size()), list_.path)),
        setup_(set_up_frames(list_.path, options, list_.camera_file, first_image_size(),
                             list_.warnings)) {
    const double given_fps = setup_.settings.fps.value_or(kDefaultFps);
    if (!list_.has_timestamps) {
      for (FrameFiles& frame : list_.frames) {
        frame.timestamp = nominal_time(frame.timestamp, given_fps);
      }
    }
    fps_ = list_.has_timestamps ? median_fps(list_.frames, given_fps) : given_fps;
    has_depth_ = any(list_.frames, &FrameFiles::depth);
    has_labels_ = any(list_.frames, &FrameFiles::mask);
  }

  int first_frame() const override { return range_.first; }
  int end_frame() const override { return range_.end; }
  double timestamp(int index) const override { return files(index).timestamp; }
  bool has_depth() const override { return has_depth_; }
  bool has_labels() const override { return has_labels_; }
  const slam::Camera& camera() const override { return setup_.settings.camera; }
  double fps() const override { return fps_; }
  std::string name() const override {
    const fs::path clean = fs::absolute(list_.path).lexically_normal();
    return (clean.has_filename() ? clean : clean.parent_path()).filename().string();
  }
  fs::path path() const override { return list_.path; }
  const std::vector<std::string>& warnings() const override { return list_.warnings; }

  slam::FrameInput read(int index) override {
    const FrameFiles& frame_files = files(index);
    slam::FrameInput frame;
    frame.index = index;
    frame.timestamp = frame_files.timestamp;
    frame.image = read_color_image(frame_files.image);
    check_size(frame.image.size(), frame_files.image);
    frame.image = resize_image(frame.image, setup_.output_size);
    if (!frame_files.depth.empty()) {
      const cv::Mat depth = read_depth_image(frame_files.depth, setup_.settings.depth_factor);
      check_shape(depth.size(), frame_files.depth);
      frame.depth = resize_nearest(depth, setup_.output_size);
    }
    if (!frame_files.mask.empty()) {
      const cv::Mat labels = read_label_image(frame_files.mask);
      check_shape(labels.size(), frame_files.mask);
      frame.labels = resize_nearest(labels, setup_.output_size);
    }
    return frame;
  }

 private:
  const FrameFiles& files(int index) const {
    return list_.frames.at(static_cast<std::size_t>(index));
  }

  /// Of the first image of the range that can be decoded: one bad frame must not stop a run that
  /// skips what it cannot read.
  cv::Size first_image_size() const {
    std::optional<UserError> first_error;
    for (int i = range_.first; i < range_.end; ++i) {
      try {
        return read_color_image(files(i).image).size();
      } catch (const UserError& error) {
        if (!first_error) first_error = error;
      }
    }
    throw UserError(first_error->what());
  }

  void check_size(cv::Size size, const fs::path& file) const {
    if (size == setup_.input_size) return;
    throw UserError(fmt::format("{}: {}x{} pixels, but the sequence began with {}x{}",
                                file.string(), size.width, size.height, setup_.input_size.width,
                                setup_.input_size.height));
  }

  /// Depth and masks may be coarser than the images, but must show the same field.
  void check_shape(cv::Size size, const fs::path& file) const {
    const cv::Size image = setup_.input_size;
    const double difference = static_cast<double>(size.width) * image.height -
                              static_cast<double>(size.height) * image.width;
    if (std::abs(difference) <= 0.01 * static_cast<double>(size.height) * image.width) return;
    throw UserError(fmt::format("{}: {}x{} pixels do not match the images' {}x{}", file.string(),
                                size.width, size.height, image.width, image.height));
  }

  ImageList list_;
  FrameRange range_;
  FrameSetup setup_;
  double fps_ = kDefaultFps;
  bool has_depth_ = false;
  bool has_labels_ = false;
};

}  // namespace

std::unique_ptr<Sequence> open_image_list(ImageList list, const SequenceOptions& options) {
  return std::make_unique<ImageListSequence>(std::move(list), options);
}

}  // namespace planecast::engine
