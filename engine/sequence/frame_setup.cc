#include "engine/sequence/frame_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "engine/user_error.h"

namespace planecast::engine {

FrameSetup set_up_frames(const std::filesystem::path& path, const SequenceOptions& options,
                         const std::filesystem::path& found_camera_file, cv::Size image_size,
                         std::vector<std::string>& warnings) {
  FrameSetup setup;
  setup.input_size = image_size;
  setup.output_size = options.size.value_or(image_size);
  if (setup.output_size.width < 16 || setup.output_size.height < 16) {
    throw UserError(fmt::format("{}: {}x{} pixels, but frames must have at least 16 a side",
                                path.string(), setup.output_size.width, setup.output_size.height));
  }
  const std::string name = options.camera.empty() ? found_camera_file.string() : options.camera;
  if (name.empty()) {
    setup.settings.camera = slam::guess_camera(image_size.width, image_size.height);
    warnings.push_back(fmt::format(
        "no camera file: assuming a field of view of 60 degrees (focal length {:.0f} px)",
        setup.settings.camera.fx));
  } else {
    setup.settings = load_camera(name);
    setup.settings.camera =
        fit_camera_to_images(setup.settings.camera, image_size.width, image_size.height, name);
  }
  if (setup.output_size != image_size) {
    setup.settings.camera =
        setup.settings.camera.scaled_to(setup.output_size.width, setup.output_size.height);
  }
  return setup;
}

FrameRange select_frames(const SequenceOptions& options, int total,
                         const std::filesystem::path& path) {
  const FrameRange range{options.first_frame,
                         options.end_frame < 0 ? total : std::min(options.end_frame, total)};
  if (range.first < 0 || range.first >= range.end) {
    throw UserError(
        fmt::format("{}: no frames in {}:{} (it has {})", path.string(), options.first_frame,
                    options.end_frame < 0 ? "" : std::to_string(options.end_frame), total));
  }
  return range;
}

cv::Mat resize_image(const cv::Mat& image, cv::Size size) {
  if (image.size() == size) return image;
  const bool shrinks = size.width < image.cols || size.height < image.rows;
  cv::Mat resized;
  cv::resize(image, resized, size, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return resized;
}

cv::Mat resize_nearest(const cv::Mat& values, cv::Size size) {
  if (values.empty() || values.size() == size) return values;
  cv::Mat resized;
  cv::resize(values, resized, size, 0, 0, cv::INTER_NEAREST_EXACT);
  return resized;
}

}  // namespace planecast::engine
