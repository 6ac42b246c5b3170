#include "slam/stages/check_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "slam/geometry/pose_system.h"

namespace planecast::slam {
namespace {

/// Rotation vector and translation of a small motion.
PoseStep motion(const Pose& from, const Pose& to) {
  const Pose change = to * from.inverse(Eigen::Isometry);
  const Eigen::AngleAxisd turn(change.linear());
  PoseStep result;
  result << turn.angle() * turn.axis(), change.translation();
  return result;
}

/// The two nearest trusted frames before and after `i`, nearest first; empty where there are fewer.
std::vector<std::size_t> trusted_about(const std::vector<char>& trusted, std::size_t i) {
  std::vector<std::size_t> about;
  for (std::size_t k = i; k-- > 0 && about.size() < 2;) {
    if (trusted[k] != 0) about.push_back(k);
  }
  if (about.size() < 2) return {};
  for (std::size_t k = i + 1; k < trusted.size() && about.size() < 4; ++k) {
    if (trusted[k] != 0) about.push_back(k);
  }
  return about.size() == 4 ? about : std::vector<std::size_t>();
}

/// How far a pose is from where its neighbours put it: angle, and distance.
struct Deviation {
  double turn = 0.0;
  double shift = 0.0;
};

class PathChecker {
 public:
  PathChecker(const std::vector<Pose>& path, const std::vector<int>& support,
              const CheckPathOptions& options)
      : path_(path), support_(support), options_(options), trusted_(path.size(), 1) {
    deviations_.resize(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) deviations_[i] = deviation(i);
    usual_.resize(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) usual_[i] = usual_about(i);
    ratios_.resize(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) ratios_[i] = ratio(i);
  }

  std::vector<char> check() {
    while (true) {
      const auto worst = std::max_element(ratios_.begin(), ratios_.end());
      if (*worst <= options_.max_ratio) return trusted_;
      const auto i = static_cast<std::size_t>(worst - ratios_.begin());
      ratios_[i] = 0.0;
      if (run_with(i) > options_.max_run) continue;
      trusted_[i] = 0;
      look_again_about(i);
    }
  }

 private:
  Deviation deviation(std::size_t i) const {
    if (trusted_about(trusted_, i).empty()) return {};
    const PoseStep away = motion(pose_between(path_, trusted_, i), path_[i]);
    return {away.head<3>().norm(), away.tail<3>().norm()};
  }

  Deviation usual_about(std::size_t i) const {
    const auto reach = static_cast<std::size_t>(options_.window);
    const std::size_t begin = i > reach ? i - reach : 0;
    const std::size_t end = std::min(path_.size(), i + reach + 1);
    std::vector<double> turns, shifts;
    for (std::size_t k = begin; k < end; ++k) {
      turns.push_back(deviations_[k].turn);
      shifts.push_back(deviations_[k].shift);
    }
    const auto median = [](std::vector<double>& values) {
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      return *middle;
    };
    return {median(turns), median(shifts)};
  }

  /// Of its own support where its neighbours have more.
  double ratio(std::size_t i) const {
    constexpr double kLeast = 1e-9;  // keeps a path without any unrest from dividing by 0
    const double far = std::max(deviations_[i].turn / std::max(usual_[i].turn, kLeast),
                                deviations_[i].shift / std::max(usual_[i].shift, kLeast));
    int most = support_[i];
    for (std::size_t k = i > 2 ? i - 2 : 0; k < std::min(support_.size(), i + 3); ++k) {
      most = std::max(most, support_[k]);
    }
    return far * std::sqrt(static_cast<double>(most) / std::max(1, support_[i]));
  }

  /// How many neighbouring frames would be in doubt with this one.
  int run_with(std::size_t i) const {
    int run = 1;
    for (std::size_t k = i; k-- > 0 && trusted_[k] == 0;) ++run;
    for (std::size_t k = i + 1; k < trusted_.size() && trusted_[k] == 0; ++k) ++run;
    return run;
  }

  void look_again_about(std::size_t i) {
    const std::size_t reach = static_cast<std::size_t>(options_.max_run) + 3;
    for (std::size_t k = i > reach ? i - reach : 0; k < std::min(path_.size(), i + reach + 1);
         ++k) {
      if (trusted_[k] == 0 || ratios_[k] == 0.0) continue;
      deviations_[k] = deviation(k);
      ratios_[k] = ratio(k);
    }
  }

  const std::vector<Pose>& path_;
  const std::vector<int>& support_;
  const CheckPathOptions& options_;
  std::vector<char> trusted_;
  std::vector<Deviation> deviations_;
  std::vector<Deviation> usual_;
  std::vector<double> ratios_;  ///< 0 where it is decided
};

}  // namespace

Pose pose_between(const std::vector<Pose>& path, const std::vector<char>& trusted, std::size_t i) {
  const std::vector<std::size_t> about = trusted_about(trusted, i);
  const Pose& origin = path[about[0]];
  PoseStep step = PoseStep::Zero();
  for (std::size_t a = 0; a < about.size(); ++a) {
    // Lagrange's polynomial of this frame, at i.
    double weight = 1.0;
    for (std::size_t b = 0; b < about.size(); ++b) {
      if (a == b) continue;
      weight *= (static_cast<double>(i) - static_cast<double>(about[b])) /
                (static_cast<double>(about[a]) - static_cast<double>(about[b]));
    }
    step += weight * motion(origin, path[about[a]]);
  }
  return stepped(origin, step);
}

std::vector<char> check_path(const std::vector<Pose>& path, const std::vector<int>& support,
                             const CheckPathOptions& options) {
  if (static_cast<int>(path.size()) < options.min_frames) {
    return std::vector<char>(path.size(), 1);
  }
  return PathChecker(path, support, options).check();
}

}  // namespace planecast::slam
