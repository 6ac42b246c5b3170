// Times the plane network beside one cv::ORB::detectAndCompute on the same images, in one run and
// on one thread, so that the ratio holds on any machine. Usage: bench_segmentation SEQUENCE
// [NETWORK.onnx] Prints Markdown.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "engine/segmentation/choose_segmenter.h"
#include "engine/sequence/sequence.h"

namespace planecast {
namespace {

/// Processor time, so that a busy machine counts less.
double cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

int run(int argc, char** argv) {
  cv::setNumThreads(1);
  engine::SequenceOptions options;
  const auto sequence = engine::open_sequence(argv[1], options);
  const auto segmenter = engine::choose_network(argc > 2 ? argv[2] : "");
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(1000);
  std::vector<double> orb_ms;
  std::vector<double> network_ms;
  for (int i = sequence->first_frame(); i < sequence->end_frame(); i += 2) {
    const slam::FrameInput frame = sequence->read(i);
    cv::Mat grey = frame.image;
    if (grey.channels() == 3) cv::cvtColor(frame.image, grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::KeyPoint> corners;
    cv::Mat descriptors;
    const double begin = cpu_ms();
    orb->detectAndCompute(grey, cv::noArray(), corners, descriptors);
    const double middle = cpu_ms();
    segmenter->segment(frame);
    network_ms.push_back(cpu_ms() - middle);
    orb_ms.push_back(middle - begin);
  }
  std::printf(
      "%s, %zu images\n\n| step | median ms | 95 %% ms | ratio |\n| --- | --- | --- | --- |\n",
      segmenter->name().c_str(), orb_ms.size());
  const double reference = quantile(orb_ms, 0.5);
  std::printf("| cv::ORB, 1000 features | %.2f | %.2f | 1.00 |\n", reference,
              quantile(orb_ms, 0.95));
  std::printf("| network and decoding | %.2f | %.2f | %.2f |\n", quantile(network_ms, 0.5),
              quantile(network_ms, 0.95), quantile(network_ms, 0.5) / reference);
  return 0;
}

}  // namespace
}  // namespace planecast

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_segmentation SEQUENCE [NETWORK.onnx]\n");
    return 2;
  }
  try {
    return planecast::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
