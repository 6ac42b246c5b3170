// Times the plane network beside one cv::ORB::detectAndCompute on the same images, in one run and
// on one thread, so that the ratio holds on any machine. Usage: bench_segmentation SEQUENCE
// [NETWORK.onnx] Prints Markdown.

#include <cstdio>
#include <exception>
#include <opencv2/core.hpp>
#include <vector>

#include "engine/segmentation/choose_segmenter.h"
#include "engine/sequence/sequence.h"
#include "test/bench/orb_call.h"

namespace planecast::bench {
namespace {

int run(int argc, char** argv) {
  cv::setNumThreads(1);
  engine::SequenceOptions options;
  const auto sequence = engine::open_sequence(argv[1], options);
  const auto segmenter = engine::choose_network(argc > 2 ? argv[2] : "");
  OrbCall orb;
  std::vector<double> orb_ms;
  std::vector<double> network_ms;
  for (int i = sequence->first_frame(); i < sequence->end_frame(); i += 2) {
    const slam::FrameInput frame = sequence->read(i);
    orb_ms.push_back(orb.measure(frame.image).cpu_ms);
    const double begin = cpu_ms();
    segmenter->segment(frame);
    network_ms.push_back(cpu_ms() - begin);
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
}  // namespace planecast::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_segmentation SEQUENCE [NETWORK.onnx]\n");
    return 2;
  }
  try {
    return planecast::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
