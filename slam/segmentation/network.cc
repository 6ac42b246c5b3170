#include "slam/segmentation/network.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

namespace planecast::slam {
namespace {

/// Which file it was: 64 bits of FNV-1a, eight hexadecimal digits.
std::string checksum(const std::vector<unsigned char>& bytes) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001B3ULL;
  char text[9];
  std::snprintf(text, sizeof(text), "%08x", static_cast<std::uint32_t>(hash ^ (hash >> 32)));
  return text;
}

/// Averages before it samples, at the price of a bilinear resize: halved as long as that is still
/// larger than what is wanted.
cv::Mat shrink(const cv::Mat& image, cv::Size size) {
  cv::Mat small = image;
  while (small.cols >= 2 * size.width && small.rows >= 2 * size.height) {
    cv::Mat half;
    cv::resize(small, half, {small.cols / 2, small.rows / 2}, 0, 0, cv::INTER_AREA);
    small = half;
  }
  if (small.size() != size) cv::resize(small, small, size, 0, 0, cv::INTER_LINEAR);
  return small;
}

/// A picture as the network wants it, 1 x 3 x h x w.
cv::Mat make_input(const cv::Mat& image, const NetworkDescription& description) {
  cv::Mat small = shrink(image, description.size);
  if (small.channels() == 1) cv::cvtColor(small, small, cv::COLOR_GRAY2BGR);
  const cv::Size& size = description.size;
  const int shape[] = {1, 3, size.height, size.width};
  cv::Mat blob(4, shape, CV_32F);
  for (int channel = 0; channel < 3; ++channel) {
    const double mean = description.mean[channel];
    const double scale = 1.0 / description.deviation[channel];
    cv::Mat plane(size, CV_32F, blob.ptr<float>(0, channel));
    cv::Mat values;
    cv::extractChannel(small, values, description.rgb ? 2 - channel : channel);
    values.convertTo(plane, CV_32F, scale, -mean * scale);
  }
  return blob;
}

/// One h x w slice of a blob.
cv::Mat slice(const cv::Mat& blob, int index) {
  const int rows = blob.size[blob.dims - 2];
  const int cols = blob.size[blob.dims - 1];
  auto* data = const_cast<float*>(blob.ptr<float>());
  return {rows, cols, CV_32F, data + static_cast<std::ptrdiff_t>(index) * rows * cols};
}

int slices(const cv::Mat& blob) {
  if (blob.dims < 3 || blob.type() != CV_32F) return -1;
  return static_cast<int>(blob.total()) /
         std::max(1, blob.size[blob.dims - 1] * blob.size[blob.dims - 2]);
}

class NetworkSegmenter : public PlaneSegmenter {
 public:
  NetworkSegmenter(const std::vector<unsigned char>& onnx, NetworkDescription description)
      : description_(std::move(description)),
        net_(cv::dnn::readNetFromONNX(std::vector<uchar>(onnx.begin(), onnx.end()))),
        name_("network " + description_.name + " " + description_.version + " " + checksum(onnx)) {
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    if (description_.kind == NetworkDescription::Kind::kMaps) {
      outputs_ = {description_.output};
      if (description_.output.empty()) outputs_ = net_.getUnconnectedOutLayersNames();
    } else {
      outputs_ = {description_.masks, description_.scores};
    }
    // A wrong name or size shows now rather than at the first keyframe.
    segment_image(cv::Mat::zeros(description_.size, CV_8UC3));
  }

  cv::Mat segment(const FrameInput& frame) override {
    if (frame.image.empty()) return {};
    const cv::Mat small = segment_image(frame.image);
    cv::Mat labels;
    cv::resize(small, labels, frame.image.size(), 0, 0, cv::INTER_NEAREST);
    return labels;
  }
  std::string name() const override { return name_; }

 private:
  cv::Mat segment_image(const cv::Mat& image) {
    net_.setInput(make_input(image, description_), description_.input);
    std::vector<cv::Mat> outputs;
    net_.forward(outputs, outputs_);
    return description_.kind == NetworkDescription::Kind::kMaps ? from_maps(outputs)
                                                                : from_instances(outputs);
  }

  cv::Mat from_maps(const std::vector<cv::Mat>& outputs) const {
    const cv::Mat& blob = outputs.at(0);
    if (blob.dims != 4 || slices(blob) != PlaneMaps::kChannels) {
      throw std::runtime_error("the output has " + std::to_string(slices(blob)) +
                               " channels instead of " + std::to_string(PlaneMaps::kChannels));
    }
    const PlaneMaps maps = PlaneMaps::of(blob.ptr<float>(), 2 * blob.size[2], 2 * blob.size[3]);
    return decode_planes(maps, description_.decode);
  }

  /// Each pixel to the best-scored instance that claims it.
  cv::Mat from_instances(const std::vector<cv::Mat>& outputs) const {
    const cv::Mat& masks = outputs.at(0);
    const cv::Mat& scores = outputs.at(1);
    const int count = slices(masks);
    if (count < 0 || scores.type() != CV_32F || static_cast<int>(scores.total()) < count) {
      throw std::runtime_error("its outputs are not masks (N x h x w) with as many scores");
    }
    std::vector<int> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    const auto* score = scores.ptr<float>();
    std::stable_sort(order.begin(), order.end(),
                     [score](int a, int b) { return score[a] > score[b]; });
    cv::Mat labels = cv::Mat::zeros(masks.size[masks.dims - 2], masks.size[masks.dims - 1], CV_16U);
    int next = 1;
    for (const int index : order) {
      if (score[index] < description_.min_score) break;
      const cv::Mat claimed = (slice(masks, index) > description_.min_mask) & (labels == 0);
      const double needed = description_.decode.min_share * static_cast<double>(labels.total());
      if (cv::countNonZero(claimed) >= needed) labels.setTo(next++, claimed);
    }
    return labels;
  }

  NetworkDescription description_;
  cv::dnn::Net net_;
  std::string name_;
  std::vector<std::string> outputs_;
};

/// OpenCV prints its errors besides throwing them; ours are one line.
int silent(int, const char*, const char*, const char*, int, void*) { return 0; }

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

LoadedNetwork load_network(const std::vector<unsigned char>& onnx,
                           const NetworkDescription& description) {
  LoadedNetwork result;
  cv::redirectError(silent);
  try {
    result.segmenter = std::make_unique<NetworkSegmenter>(onnx, description);
  } catch (const cv::Exception& error) {
    result.error =
        "is no ONNX network that can be used with its description (" + first_line(error.err) + ")";
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  cv::redirectError(nullptr);
  return result;
}

}  // namespace planecast::slam
