#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slam/fitting/fit_homography.h"
#include "slam/fitting/graph_cut_ransac.h"
#include "slam/fitting/neighbourhood.h"
#include "slam/fitting/plane_model.h"
#include "slam/fitting/samplers.h"
#include "slam/geometry/random.h"
#include "test/bench/fitting/report.h"
#include "test/bench/fitting/worlds.h"

/// Graph-cut RANSAC against plain sequential RANSAC and OpenCV's findHomography over noise,
/// outliers and corrupted masks.  bench_fitting [folder] [trials]

namespace planecast::bench {
namespace {

constexpr double kThreshold_px = 2.0;
/// Thresholds of planes at 2 m: 0.02 and 0.01 of the distance.
constexpr double kEpsD_m = 0.04;
constexpr double kEpsPi_m = 0.02;
/// Error of a fit that failed.
constexpr double kFailed = 1e3;

struct Trial {
  double f = 0.0;
  double error = kFailed;
  double offset_cm = kFailed;
  double milliseconds = 0.0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double f_score(const std::vector<char>& labelled, const std::vector<char>& truth) {
  int both = 0, either = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    both += labelled[i] && truth[i];
    either += (labelled[i] != 0) + (truth[i] != 0);
  }
  return either > 0 ? 2.0 * both / either : 0.0;
}

template <typename Run>
double time_ms(Run run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

Row summarise(const std::string& setting, const std::string& method,
              const std::vector<Trial>& trials) {
  Row row{setting, method, 0.0, 0.0, 0.0, 0.0};
  std::vector<double> errors, offsets, times;
  for (const Trial& trial : trials) {
    row.f += trial.f / static_cast<double>(trials.size());
    errors.push_back(trial.error);
    offsets.push_back(trial.offset_cm);
    times.push_back(trial.milliseconds);
  }
  row.error = median(errors);
  row.offset_cm = median(offsets);
  row.milliseconds = median(times);
  return row;
}

/// Median distance between true and estimated transfer over the instance.
double transfer_error(const Eigen::Matrix3d& estimate, const HomographyWorld& world) {
  std::vector<double> distances;
  for (const Eigen::Vector2d& x : world.region) {
    distances.push_back(((estimate * x.homogeneous()).hnormalized() -
                         (world.cur_H_ref * x.homogeneous()).hnormalized())
                            .norm());
  }
  return median(distances);
}

Trial run_ours(const HomographyWorld& world, bool graph_cut, std::uint64_t seed) {
  slam::HomographyOptions options;
  options.graph_cut = graph_cut;
  options.seed = seed;
  std::optional<slam::HomographyFit> fit;
  Trial trial;
  trial.milliseconds =
      time_ms([&] { fit = slam::fit_homography(world.pairs, world.quality, {}, options); });
  if (!fit) return trial;
  trial.f = f_score(fit->inlier, world.inlier);
  trial.error = transfer_error(fit->cur_H_ref, world);
  return trial;
}

Trial run_opencv(const HomographyWorld& world, int method) {
  std::vector<cv::Point2f> ref, cur;
  for (const slam::PointPair& pair : world.pairs) {
    ref.emplace_back(static_cast<float>(pair.ref.x()), static_cast<float>(pair.ref.y()));
    cur.emplace_back(static_cast<float>(pair.cur.x()), static_cast<float>(pair.cur.y()));
  }
  cv::Mat h;
  std::vector<char> mask;
  Trial trial;
  trial.milliseconds =
      time_ms([&] { h = cv::findHomography(ref, cur, method, kThreshold_px, mask, 2000, 0.99); });
  if (h.empty()) return trial;
  Eigen::Matrix3d estimate;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) estimate(r, c) = h.at<double>(r, c);
  }
  mask.resize(world.inlier.size(), 0);
  trial.f = f_score(mask, world.inlier);
  trial.error = transfer_error(estimate, world);
  return trial;
}

Trial run_plane(const PlaneWorld& world, bool graph_cut, std::uint64_t seed) {
  const slam::PlaneModel model(world.points);
  slam::RansacOptions options;
  options.threshold = kEpsD_m;
  options.max_rms = kEpsPi_m;
  options.lambda = 0.6;
  options.graph_cut = graph_cut;
  options.max_samples = 500;
  options.max_stagnant_rounds = 1;
  options.seed = seed;
  slam::RansacResult<slam::PlaneEquation> result;
  Trial trial;
  trial.milliseconds = time_ms([&] {
    std::vector<slam::NeighbourPair> neighbours;
    if (graph_cut) neighbours = slam::radius_neighbours(world.points.positions, 2.0 * kEpsD_m);
    slam::UniformSampler sampler(model.size(), slam::PlaneModel::kSampleSize);
    result = slam::GraphCutRansac(model, sampler, neighbours, options).run();
  });
  if (!result.found) return trial;
  trial.f = f_score(result.inlier, world.inlier);
  const double cosine = std::min(1.0, std::abs(result.model.normal.dot(world.plane.normal)));
  trial.error = std::acos(cosine) * 180.0 / M_PI;
  trial.offset_cm = 100.0 * std::abs(result.model.signed_distance(world.centroid));
  return trial;
}

Trial run_least_squares(const PlaneWorld& world) {
  std::optional<slam::PlaneFit> fit;
  Trial trial;
  trial.milliseconds = time_ms([&] { fit = slam::fit_plane(world.points.positions); });
  if (!fit) return trial;
  trial.f = f_score(std::vector<char>(world.inlier.size(), 1), world.inlier);
  const double cosine = std::min(1.0, std::abs(fit->plane.normal.dot(world.plane.normal)));
  trial.error = std::acos(cosine) * 180.0 / M_PI;
  trial.offset_cm = 100.0 * std::abs(fit->plane.signed_distance(world.centroid));
  return trial;
}

std::vector<Mask> masks() {
  std::vector<Mask> result = {{Corruption::kNone, 0.0}};
  for (const double share : {0.1, 0.2, 0.3}) result.push_back({Corruption::kErosion, share});
  for (const double share : {0.05, 0.1, 0.2, 0.3}) result.push_back({Corruption::kLeakage, share});
  result.push_back({Corruption::kMerged, 0.3});
  result.push_back({Corruption::kMerged, 0.45});
  result.push_back({Corruption::kSplit, 0.5});
  return result;
}

class Bench {
 public:
  explicit Bench(int trials) : trials_(trials) {}

  void homographies(Table& table, const std::string& setting, int points, double noise_px,
                    double outliers, const Mask& mask) {
    const auto make = [&](std::uint64_t seed) {
      return make_homography_world(points, noise_px, outliers, mask, seed);
    };
    using World = HomographyWorld;
    measure<World>(
        table, setting, make,
        {{"graph cut", [](const World& w, std::uint64_t s) { return run_ours(w, true, s); }},
         {"plain", [](const World& w, std::uint64_t s) { return run_ours(w, false, s); }},
         {"OpenCV RANSAC", [](const World& w, std::uint64_t) { return run_opencv(w, cv::RANSAC); }},
         {"OpenCV LMEDS", [](const World& w, std::uint64_t) { return run_opencv(w, cv::LMEDS); }},
         {"OpenCV USAC_MAGSAC",
          [](const World& w, std::uint64_t) { return run_opencv(w, cv::USAC_MAGSAC); }}});
  }

  void planes(Table& table, const std::string& setting, int points, double noise_m, double outliers,
              const Mask& mask) {
    const auto make = [&](std::uint64_t seed) {
      return make_plane_world(points, noise_m, outliers, mask, seed);
    };
    using World = PlaneWorld;
    measure<World>(
        table, setting, make,
        {{"graph cut", [](const World& w, std::uint64_t s) { return run_plane(w, true, s); }},
         {"plain", [](const World& w, std::uint64_t s) { return run_plane(w, false, s); }},
         {"least squares", [](const World& w, std::uint64_t) { return run_least_squares(w); }}});
  }

 private:
  template <typename World>
  struct Method {
    std::string name;
    std::function<Trial(const World&, std::uint64_t)> run;
  };

  template <typename World>
  void measure(Table& table, const std::string& setting,
               const std::function<World(std::uint64_t)>& make,
               const std::vector<Method<World>>& methods) {
    std::vector<std::vector<Trial>> results(methods.size());
    ++setting_;
    for (int t = 0; t < trials_; ++t) {
      const std::uint64_t seed = slam::mix_seed(setting_, static_cast<std::uint64_t>(t));
      const World world = make(seed);
      for (std::size_t m = 0; m < methods.size(); ++m) {
        results[m].push_back(methods[m].run(world, seed));
      }
    }
    for (std::size_t m = 0; m < methods.size(); ++m) {
      table.rows.push_back(summarise(setting, methods[m].name, results[m]));
    }
  }

  int trials_;
  std::uint64_t setting_ = 0;
};

std::vector<Table> run_all(int trials) {
  Bench bench(trials);
  const std::string about_h =
      "Symmetric transfer error threshold 2 px; error: median over a grid on the instance of the "
      "distance to the true transfer.";
  std::vector<Table> tables;
  Table size{"Homographies: number of matches and outliers", about_h + " Noise 0.5 px.", "px", {}};
  for (const int points : {1000, 4000}) {
    for (const double outliers : {0.15, 0.35, 0.55}) {
      bench.homographies(size, fmt::format("{} matches, {:.0f} % out", points, 100.0 * outliers),
                         points, 0.5, outliers, {});
    }
  }
  tables.push_back(size);
  Table noise{"Homographies: noise", about_h + " 1000 matches, 35 % outliers.", "px", {}};
  for (const double px : {0.25, 0.5, 1.0}) {
    bench.homographies(noise, fmt::format("noise {} px", px), 1000, px, 0.35, {});
  }
  tables.push_back(noise);
  Table masked{"Homographies: corrupted masks",
               about_h + " 300 matches in the mask, noise 0.5 px, 15 % gross outliers.",
               "px",
               {}};
  for (const Mask& mask : masks()) {
    bench.homographies(masked, name_of(mask), 300, 0.5, 0.15, mask);
  }
  tables.push_back(masked);
  const std::string about_p = "Inlier distance 4 cm, accepted RMS 2 cm, as at 2 m. ";
  Table plane_noise{
      "Planes: noise and outliers", about_p + "300 landmarks in a clean mask.", "deg", {}};
  for (const double cm : {0.5, 1.0, 1.5}) {
    for (const double outliers : {0.1, 0.3, 0.5}) {
      bench.planes(plane_noise, fmt::format("noise {} cm, {:.0f} % out", cm, 100.0 * outliers), 300,
                   0.01 * cm, outliers, {});
    }
  }
  tables.push_back(plane_noise);
  Table plane_masks{"Planes: corrupted masks",
                    about_p + "300 landmarks in the mask, noise 1 cm, 10 % gross outliers.",
                    "deg",
                    {}};
  for (const Mask& mask : masks()) {
    bench.planes(plane_masks, name_of(mask), 300, 0.01, 0.1, mask);
  }
  tables.push_back(plane_masks);
  return tables;
}

/// A process that does nothing but fits would give its memory back after each and ask for it again;
/// among the allocations of a program that runs on it stays. Holds for every method.
void keep_memory() {
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
}

}  // namespace
}  // namespace planecast::bench

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "docs/bench";
  const int trials = argc > 2 ? std::max(1, std::atoi(argv[2])) : 100;
  cv::setNumThreads(1);
  planecast::bench::keep_memory();
  const std::string introduction = fmt::format(
      "# Fitting: graph-cut RANSAC against others\n\nWritten by `bench_fitting` over {} random "
      "worlds a setting, the same ones for every method. F: mean F-score of the inlier labels "
      "against the truth; error, offset and ms: medians. A failed fit has F 0. *plain* is the same "
      "code with `graph_cut = false`: sequential RANSAC with the final least squares. OpenCV's "
      "methods run with a threshold of 2 px, confidence 0.99 and at most 2000 iterations, on one "
      "thread.\n",
      trials);
  planecast::bench::write_report(folder, "fitting", introduction,
                                 planecast::bench::run_all(trials));
  return 0;
}
