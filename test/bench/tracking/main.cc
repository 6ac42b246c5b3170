// Times tracking and mapping beside one cv::ORB::detectAndCompute on the same images, in one run,
// so that the ratio holds on any machine. Usage: bench_tracking SEQUENCE [mono|rgbd] [CAMERA]
// Prints Markdown.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "engine/sequence/sequence.h"
#include "slam/system.h"

namespace planecast {
namespace {

using Times = std::map<std::string, std::vector<double>>;

double now_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print(const char* name, const std::vector<double>& times, double orb_ms) {
  const double median = quantile(times, 0.5);
  std::printf("| %s | %zu | %.2f | %.2f | %.2f |\n", name, times.size(), median,
              quantile(times, 0.95), median / orb_ms);
}

/// Tracks the sequence with mapping inline, so that nothing else runs while a time is taken.
Times measure(engine::Sequence& sequence, bool rgbd) {
  slam::SystemOptions options;
  options.rgbd = rgbd;
  options.threads = 1;
  slam::System system(options, sequence.camera(), slam::make_no_segmenter());
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(1000);
  Times times;
  for (int i = sequence.first_frame(); i < sequence.end_frame(); ++i) {
    const slam::FrameInput frame = sequence.read(i);
    cv::Mat grey = frame.image;
    if (grey.channels() == 3) cv::cvtColor(frame.image, grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::KeyPoint> corners;
    cv::Mat descriptors;
    const double begin = now_ms();
    orb->detectAndCompute(grey, cv::noArray(), corners, descriptors);
    times["ORB"].push_back(now_ms() - begin);

    const slam::FrameTrack track = system.track(system.prepare(frame, system.initialised()));
    for (const auto& [stage, ms] : track.times) times[stage].push_back(ms);
    for (const auto& [stage, ms] : track.mapping_times) times[stage].push_back(ms);
  }
  return times;
}

int run(int count, char** arguments) {
  if (count < 2) {
    std::fputs("usage: bench_tracking SEQUENCE [mono|rgbd] [CAMERA]\n", stderr);
    return 2;
  }
  cv::setNumThreads(1);
  engine::SequenceOptions options;
  if (count > 3) options.camera = arguments[3];
  const auto sequence = engine::open_sequence(arguments[1], options);
  Times times = measure(*sequence, count > 2 && std::string(arguments[2]) == "rgbd");
  const double orb_ms = quantile(times["ORB"], 0.5);
  std::puts("| step | count | median ms | p95 ms | median, in calls of cv::ORB |");
  std::puts("| --- | --- | --- | --- | --- |");
  for (const auto& [stage, values] : times) print(stage.c_str(), values, orb_ms);
  return 0;
}

}  // namespace
}  // namespace planecast

int main(int count, char** arguments) {
  try {
    return planecast::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
