// Milliseconds a frame of an object layer with its composite, against one ORB extraction in the
// same run on the same machine, and where the time goes. Two renderers on two threads share the
// frames.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>
#include <vector>

#include "bench_scene.h"
#include "engine/look/object_layer.h"
#include "render/renderer.h"

namespace planecast::bench {
namespace {

constexpr int kFrames = 100;
constexpr int kWarmUp = 4;

double now_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Blobs and lines of many sizes, so that ORB finds its thousand features.
cv::Mat procedural_frame() {
  cv::Mat frame(480, 640, CV_8UC3, cv::Scalar(120, 120, 120));
  cv::RNG random(1);
  for (int i = 0; i < 700; ++i) {
    const cv::Point at(random.uniform(0, 640), random.uniform(0, 480));
    const cv::Size size(random.uniform(4, 60), random.uniform(4, 60));
    cv::rectangle(
        frame, cv::Rect(at, size),
        cv::Scalar(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255)),
        cv::FILLED);
  }
  cv::Mat noise(frame.size(), CV_8UC3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 12);
  return frame + noise;
}

cv::Mat test_frame(int argc, char** argv) {
  const cv::Mat given = argc > 1 ? cv::imread(argv[1]) : cv::Mat();
  if (given.empty()) return procedural_frame();
  cv::Mat frame;
  cv::resize(given, frame, cv::Size(640, 480));
  return frame;
}

double orb_ms(const cv::Mat& frame) {
  cv::Mat grey;
  cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  const auto orb = cv::ORB::create(1000);
  std::vector<double> times;
  for (int i = 0; i < 25; ++i) {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    const double begin = now_ms();
    orb->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
    times.push_back(now_ms() - begin);
  }
  std::ranges::sort(times);
  return times[times.size() / 2];
}

render::RendererOptions options_for(bool simplify) {
  render::RendererOptions options;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  if (!simplify) options.simplify_px = 0.0F;
  return options;
}

void draw(render::Renderer& renderer, const render::LayerScene& scene, int frame,
          const cv::Mat& video, cv::Mat& picture) {
  video.copyTo(picture);
  render::Layer layer = renderer.draw_layer(scene, camera_at(frame));
  engine::composite(engine::view_layer(layer), picture);
}

struct Throughput {
  double wall_ms = 0.0;  ///< a frame
  double cpu_ms = 0.0;
};

Throughput measure(const render::LayerScene& scene, const cv::Mat& video, bool simplify,
                   int threads) {
  std::vector<std::unique_ptr<render::Renderer>> renderers(static_cast<std::size_t>(threads));
  const auto run = [&](int thread, int first, int last) {
    auto& renderer = renderers[static_cast<std::size_t>(thread)];
    if (!renderer) renderer = std::make_unique<render::Renderer>(options_for(simplify));
    cv::Mat picture;
    for (int i = first + thread; i < last; i += threads) draw(*renderer, scene, i, video, picture);
  };
  const auto run_all = [&](int first, int last) {
    std::vector<std::thread> workers;
    for (int t = 0; t < threads; ++t) workers.emplace_back(run, t, first, last);
    for (std::thread& worker : workers) worker.join();
  };
  run_all(0, kWarmUp * threads);
  const double begin = now_ms();
  const double cpu = cpu_ms();
  run_all(0, kFrames);
  return {(now_ms() - begin) / kFrames, (cpu_ms() - cpu) / kFrames};
}

double covered_share(render::LayerScene scene) {
  scene.with_depth = true;
  render::Renderer renderer(options_for(true));
  const render::Layer layer = renderer.draw_layer(scene, camera_at(0));
  const auto covered =
      std::ranges::count_if(layer.depth.pixels, [](float depth) { return depth > 0.0F; });
  return static_cast<double>(covered) / static_cast<double>(layer.depth.pixels.size());
}

void report_passes(const render::LayerScene& scene, const cv::Mat& video, bool simplify) {
  render::RendererOptions options = options_for(simplify);
  options.time_passes = true;
  render::Renderer renderer(options);
  cv::Mat picture;
  double composite_ms = 0.0;
  for (int i = 0; i < kWarmUp; ++i) draw(renderer, scene, i, video, picture);
  renderer.pass_times_ms();
  constexpr int kTimed = 40;
  for (int i = 0; i < kTimed; ++i) {
    render::Layer layer = renderer.draw_layer(scene, camera_at(i));
    const double begin = now_ms();
    video.copyTo(picture);
    engine::composite(engine::view_layer(layer), picture);
    composite_ms += now_ms() - begin;
  }
  for (const auto& [pass, ms] : renderer.pass_times_ms()) {
    std::printf("    %-20s %6.2f ms\n", pass.c_str(), ms / kTimed);
  }
  std::printf("    %-20s %6.2f ms\n", "composite", composite_ms / kTimed);
}

int run(int argc, char** argv) {
  cv::setNumThreads(1);
  const cv::Mat video = test_frame(argc, argv);
  for (const int triangles : {20000, 100000}) {
    const render::LayerScene scene = table_scene(bumpy_ball(triangles));
    std::printf("%d triangles, covering %.1f %% of 640x480\n", triangles,
                100.0 * covered_share(scene));
    for (const bool simplify : {true, false}) {
      for (const int threads : {1, 2}) {
        const double orb = orb_ms(video);
        const Throughput found = measure(scene, video, simplify, threads);
        std::printf("  %-12s %d threads  %6.2f ms a frame (cpu %6.2f)  ORB %6.2f ms  ratio %.2f\n",
                    simplify ? "simplified" : "as it is", threads, found.wall_ms, found.cpu_ms, orb,
                    found.wall_ms / orb);
      }
      report_passes(scene, video, simplify);
    }
  }
  return 0;
}

}  // namespace
}  // namespace planecast::bench

int main(int argc, char** argv) { return planecast::bench::run(argc, argv); }
