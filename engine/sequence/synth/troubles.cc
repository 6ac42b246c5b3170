#include "engine/sequence/synth/troubles.h"

#include <cmath>
#include <map>
#include <stdexcept>

#include "engine/sequence/synth/prints.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {
namespace {

constexpr double kPassEvery_s = 4.0;
constexpr double kPassFirst_s = 1.0;
constexpr double kPassTakes_s = 2.5;
constexpr double kPassDepth_m = 1.0;
constexpr double kPassReach_m = 1.1;  ///< to both sides of the middle
constexpr double kCardWidth_m = 0.5;
constexpr double kCardHeight_m = 1.1;

constexpr double kGapEvery_s = 3.0;
constexpr double kGapTakes_s = 0.4;

std::map<std::string, Trouble> make_troubles() {
  std::map<std::string, Trouble> troubles = {{"none", Trouble()}};
  troubles["blur"].shutter_s = 0.033;
  troubles["blur"].speed = 3.0;
  troubles["exposure"].exposure_jumps = true;
  troubles["rolling-shutter"].readout_s = 0.028;
  troubles["moving"].passer = true;
  troubles["dropped"].dropped_share = 0.3;
  return troubles;
}

const std::map<std::string, Trouble>& troubles() {
  static const std::map<std::string, Trouble> kTroubles = make_troubles();
  return kTroubles;
}

}  // namespace

std::vector<std::string> trouble_names() {
  std::vector<std::string> names;
  for (const auto& [name, trouble] : troubles()) names.push_back(name);
  return names;
}

Trouble trouble_named(const std::string& name) {
  const auto found = troubles().find(name);
  if (found == troubles().end()) throw std::invalid_argument(name + ": no such trouble");
  return found->second;
}

bool is_dropped(const Trouble& trouble, int frame, double time_s, std::uint64_t seed) {
  if (trouble.dropped_share <= 0.0 || frame == 0) return false;
  if (std::fmod(time_s, kGapEvery_s) > kGapEvery_s - kGapTakes_s) return true;
  Random random(mix_bits(seed ^ mix_bits(static_cast<std::uint64_t>(frame))));
  return random.uniform() < trouble.dropped_share;
}

Passer::Passer(std::uint64_t seed) : picture_(draw_print(PrintKind::kMagazine, 250, 550, seed)) {}

void Passer::draw(const CameraPath& path, const slam::Camera& camera, double time_s, cv::Mat& bgr,
                  cv::Mat& labels, cv::Mat& depth_m) const {
  if (time_s < kPassFirst_s) return;
  const double start_s =
      kPassFirst_s + kPassEvery_s * std::floor((time_s - kPassFirst_s) / kPassEvery_s);
  const double share = (time_s - start_s) / kPassTakes_s;
  if (share > 1.0) return;
  // It goes its own way: the camera moves on while it passes.
  const slam::Pose cam_from_card =
      path.world_from_cam(time_s).inverse() * path.world_from_cam(start_s) *
      Eigen::Translation3d((2.0 * share - 1.0) * kPassReach_m, 0.1, kPassDepth_m);
  const Eigen::Vector3d normal = cam_from_card.linear().col(2);
  const slam::Pose card_from_cam = cam_from_card.inverse();
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      const Eigen::Vector3d ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
      const double z = normal.dot(cam_from_card.translation()) / normal.dot(ray);
      const float behind = depth_m.at<float>(y, x);
      if (!(z > 0.1) || (behind > 0.0F && z > static_cast<double>(behind))) continue;
      const Eigen::Vector3d at = card_from_cam * (z * ray);
      const double u = at.x() / kCardWidth_m + 0.5;
      const double v = at.y() / kCardHeight_m + 0.5;
      if (u < 0.0 || u >= 1.0 || v < 0.0 || v >= 1.0) continue;
      bgr.at<cv::Vec3b>(y, x) = picture_.at<cv::Vec3b>(static_cast<int>(v * picture_.rows),
                                                       static_cast<int>(u * picture_.cols));
      labels.at<std::uint8_t>(y, x) = 0;
      depth_m.at<float>(y, x) = static_cast<float>(z);
    }
  }
}

}  // namespace planecast::engine::synth
