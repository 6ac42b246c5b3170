// Times tracking and mapping beside one cv::ORB::detectAndCompute on the same images, in one run,
// so that the ratio holds on any machine. Usage: bench_tracking SEQUENCE [mono|rgbd] [CAMERA]
// Prints Markdown.

#include <cstdio>
#include <exception>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/sequence/sequence.h"
#include "slam/system.h"
#include "test/bench/orb_call.h"

namespace planecast::bench {
namespace {

using Times = std::map<std::string, std::vector<double>>;

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
  OrbCall orb;
  Times times;
  for (int i = sequence.first_frame(); i < sequence.end_frame(); ++i) {
    const slam::FrameInput frame = sequence.read(i);
    times["ORB"].push_back(orb.measure(frame.image).wall_ms);

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
}  // namespace planecast::bench

int main(int count, char** arguments) {
  try {
    return planecast::bench::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
