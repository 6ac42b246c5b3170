#include "engine/evaluate/masks.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "engine/cancel.h"
#include "engine/sequence/image_file.h"
#include "engine/sequence/list_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

LabelPairs count_pairs(const cv::Mat& estimate, const cv::Mat& truth) {
  LabelPairs pairs;
  for (int y = 0; y < truth.rows; ++y) {
    const auto* true_label = truth.ptr<std::uint16_t>(y);
    const auto* label = estimate.ptr<std::uint16_t>(y);
    // Neighbours mostly agree: a run is counted at once.
    int start = 0;
    for (int x = 1; x <= truth.cols; ++x) {
      if (x < truth.cols && true_label[x] == true_label[start] && label[x] == label[start])
        continue;
      pairs[{true_label[start], label[start]}] += x - start;
      start = x;
    }
  }
  return pairs;
}

std::map<double, std::filesystem::path> mask_files(const std::filesystem::path& folder) {
  std::map<double, std::filesystem::path> files;
  for (const TimedFile& file : read_timed_files(folder / "mask.txt")) {
    files[file.timestamp] = file.file;
  }
  return files;
}

double mean(double sum, int count) { return count > 0 ? sum / count : 0.0; }

}  // namespace

MaskScore score_masks(const cv::Mat& estimate, const cv::Mat& truth, const MaskOptions& options) {
  const LabelPairs pairs = count_pairs(estimate, truth);
  std::map<int, double> true_area;
  std::map<int, double> area;
  for (const auto& [labels, count] : pairs) {
    true_area[labels.first] += static_cast<double>(count);
    area[labels.second] += static_cast<double>(count);
  }
  MaskScore score;
  score.partition = score_partition(pairs);
  const double needed = options.min_true_share * static_cast<double>(truth.total());
  for (const auto& [label, pixels] : true_area) score.truth += label != 0 && pixels >= needed;
  for (const auto& [label, pixels] : area) score.estimated += label != 0;
  // Above an IoU of one half at most one instance can overlap another.
  std::set<int> taken;
  for (const auto& [labels, count] : pairs) {
    const auto [true_label, label] = labels;
    if (true_label == 0 || label == 0 || true_area[true_label] < needed) continue;
    const double united = true_area[true_label] + area[label] - static_cast<double>(count);
    if (static_cast<double>(count) < options.min_iou * united) continue;
    if (taken.insert(label).second) ++score.found;
  }
  return score;
}

void MaskSums::add_without_estimate(const MaskScore& score) {
  ++sums_.frames;
  ++sums_.without_estimate;
  sums_.truth += score.truth;
}

void MaskSums::add(const MaskScore& score) {
  ++sums_.frames;
  sums_.truth += score.truth;
  sums_.estimated += score.estimated;
  sums_.found += score.found;
  sums_.rand_index += score.partition.rand_index;
  sums_.variation_of_information += score.partition.variation_of_information;
  sums_.segmentation_covering += score.partition.segmentation_covering;
}

MaskResult MaskSums::result() const {
  MaskResult result = sums_;
  const int both = result.frames - result.without_estimate;
  result.recall = mean(result.found, result.truth);
  result.precision = mean(result.found, result.estimated);
  result.rand_index = mean(result.rand_index, both);
  result.variation_of_information = mean(result.variation_of_information, both);
  result.segmentation_covering = mean(result.segmentation_covering, both);
  return result;
}

MaskResult evaluate_masks(const std::filesystem::path& masks, Sequence& truth,
                          const MaskOptions& options) {
  if (!truth.has_labels()) throw UserError(truth.path().string() + ": has no true masks");
  std::vector<double> times;
  std::vector<std::filesystem::path> files;
  for (const auto& [time, file] : mask_files(masks)) {
    times.push_back(time);
    files.push_back(file);
  }
  std::vector<double> frame_times;
  for (int i = truth.first_frame(); i < truth.end_frame(); ++i) {
    frame_times.push_back(truth.timestamp(i));
  }
  const std::vector<int> partner = pair_by_time(frame_times, times);
  MaskSums sums;
  for (int i = truth.first_frame(); i < truth.end_frame(); ++i) {
    throw_if_cancelled();
    const cv::Mat true_labels = truth.read(i).labels;
    if (true_labels.empty()) continue;
    const int file = partner[static_cast<std::size_t>(i - truth.first_frame())];
    cv::Mat labels = cv::Mat::zeros(true_labels.size(), CV_16U);
    if (file >= 0) {
      labels = read_label_image(files[static_cast<std::size_t>(file)]);
      if (labels.size() != true_labels.size()) {
        cv::resize(labels, labels, true_labels.size(), 0, 0, cv::INTER_NEAREST_EXACT);
      }
    }
    const MaskScore score = score_masks(labels, true_labels, options);
    file < 0 ? sums.add_without_estimate(score) : sums.add(score);
  }
  const MaskResult result = sums.result();
  if (result.frames == result.without_estimate) {
    throw UserError(masks.string() + ": no mask is within 20 ms of a frame of " +
                    truth.path().string());
  }
  return result;
}

std::string format_table(const MaskResult& result) {
  return fmt::format(
      "{} frames, {} of them without a mask; {} true planes, {} estimated, {} found\n"
      "{:>10} {:>10} {:>8} {:>10} {:>8}\n{:>10.3f} {:>10.3f} {:>8.3f} {:>10.3f} {:>8.3f}\n",
      result.frames, result.without_estimate, result.truth, result.estimated, result.found,
      "recall", "precision", "RI", "VOI nats", "SC", result.recall, result.precision,
      result.rand_index, result.variation_of_information, result.segmentation_covering);
}

nlohmann::ordered_json to_json(const MaskResult& result) {
  nlohmann::ordered_json json;
  json["frames"] = result.frames;
  json["frames_without_mask"] = result.without_estimate;
  json["true_planes"] = result.truth;
  json["estimated_planes"] = result.estimated;
  json["found_planes"] = result.found;
  json["recall"] = result.recall;
  json["precision"] = result.precision;
  json["rand_index"] = result.rand_index;
  json["variation_of_information"] = result.variation_of_information;
  json["segmentation_covering"] = result.segmentation_covering;
  return json;
}

}  // namespace planecast::engine
