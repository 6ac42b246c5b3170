// Usage: bench_render [WAY]... [IMAGE]; ways are simplified, as-is and opengl, by default all.
//
// Milliseconds a frame of an object layer with its composite, against one ORB extraction in the
// same run on the same machine, and where the time goes. With two threads, two renderers share the
// frames. On a machine that does other things too, processor time says what wall time cannot.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <vector>

#include "bench_scene.h"
#include "engine/look/object_layer.h"
#include "render/renderer.h"
#include "test/bench/orb_call.h"

namespace planecast::bench {
namespace {

/// Frames and extractions take turns, so that whatever else the machine does meets both.
constexpr int kRounds = 5;
constexpr int kFramesPerRound = 20;
constexpr int kExtractionsPerRound = 7;
constexpr int kWarmUp = 4;

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

cv::Mat test_frame(const std::string& path) {
  const cv::Mat given = path.empty() ? cv::Mat() : cv::imread(path);
  if (given.empty()) return procedural_frame();
  cv::Mat frame;
  cv::resize(given, frame, cv::Size(640, 480));
  return frame;
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

/// What the figures are compared with: one thread, 1000 features.
Cost orb_cost(const cv::Mat& frame) {
  OrbCall orb;
  std::vector<double> wall;
  std::vector<double> cpu;
  for (int i = 0; i < kExtractionsPerRound; ++i) {
    const Cost call = orb.measure(frame);
    wall.push_back(call.wall_ms);
    cpu.push_back(call.cpu_ms);
  }
  return {median(wall), median(cpu)};
}

struct Way {
  const char* name;
  bool simplify = true;
  bool only_opengl = false;
};

render::RendererOptions options_for(const Way& way) {
  render::RendererOptions options;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  options.only_opengl = way.only_opengl;
  if (!way.simplify) options.simplify_px = 0.0F;
  return options;
}

void draw(render::Renderer& renderer, const render::LayerScene& scene, int frame,
          const cv::Mat& video, cv::Mat& picture) {
  video.copyTo(picture);
  render::Layer layer = renderer.draw_layer(scene, camera_at(frame));
  engine::composite(engine::view_layer(layer), picture);
}

/// Draws consecutive frames, shared among threads that each have a renderer of their own.
class Frames {
 public:
  Frames(const render::LayerScene& scene, const cv::Mat& video, const Way& way, int threads)
      : scene_(&scene), video_(&video), way_(way), renderers_(static_cast<std::size_t>(threads)) {
    draw_next(kWarmUp * threads);
  }

  /// The mean of the next frames.
  Cost draw_next(int count) {
    const double begin = wall_ms();
    const double cpu = cpu_ms();
    std::vector<std::thread> workers;
    for (std::size_t t = 0; t < renderers_.size(); ++t) {
      workers.emplace_back([this, t, count] { work(t, count); });
    }
    for (std::thread& worker : workers) worker.join();
    next_ += count;
    return {(wall_ms() - begin) / count, (cpu_ms() - cpu) / count};
  }

 private:
  void work(std::size_t thread, int count) {
    auto& renderer = renderers_[thread];
    if (!renderer) renderer = std::make_unique<render::Renderer>(options_for(way_));
    cv::Mat picture;
    const int step = static_cast<int>(renderers_.size());
    for (int i = next_ + static_cast<int>(thread); i < next_ + count; i += step) {
      draw(*renderer, *scene_, i, *video_, picture);
    }
  }

  const render::LayerScene* scene_;
  const cv::Mat* video_;
  Way way_;
  std::vector<std::unique_ptr<render::Renderer>> renderers_;
  int next_ = 0;
};

double covered_share(render::LayerScene scene) {
  scene.with_depth = true;
  render::Renderer renderer(options_for({}));
  const render::Layer layer = renderer.draw_layer(scene, camera_at(0));
  const auto covered =
      std::ranges::count_if(layer.depth.pixels, [](float depth) { return depth > 0.0F; });
  return static_cast<double>(covered) / static_cast<double>(layer.depth.pixels.size());
}

void report_passes(const render::LayerScene& scene, const cv::Mat& video, const Way& way) {
  render::RendererOptions options = options_for(way);
  options.time_passes = true;
  render::Renderer renderer(options);
  cv::Mat picture;
  double composite_ms = 0.0;
  for (int i = 0; i < kWarmUp; ++i) draw(renderer, scene, i, video, picture);
  renderer.pass_times_ms();
  constexpr int kTimed = 40;
  for (int i = 0; i < kTimed; ++i) {
    render::Layer layer = renderer.draw_layer(scene, camera_at(i));
    const double begin = wall_ms();
    video.copyTo(picture);
    engine::composite(engine::view_layer(layer), picture);
    composite_ms += wall_ms() - begin;
  }
  for (const auto& [pass, ms] : renderer.pass_times_ms()) {
    std::printf("    %-20s %6.2f ms\n", pass.c_str(), ms / kTimed);
  }
  std::printf("    %-20s %6.2f ms\n", "composite", composite_ms / kTimed);
}

void report(const render::LayerScene& scene, const cv::Mat& video, const Way& way) {
  for (const int threads : {1, 2}) {
    Frames frames(scene, video, way, threads);
    std::vector<double> frame_ms, frame_cpu, orb_ms, orb_cpu, by_time, by_cpu;
    for (int round = 0; round < kRounds; ++round) {
      const Cost orb = orb_cost(video);
      const Cost frame = frames.draw_next(kFramesPerRound);
      frame_ms.push_back(frame.wall_ms);
      frame_cpu.push_back(frame.cpu_ms);
      orb_ms.push_back(orb.wall_ms);
      orb_cpu.push_back(orb.cpu_ms);
      by_time.push_back(frame.wall_ms / orb.wall_ms);
      by_cpu.push_back(frame.cpu_ms / threads / orb.cpu_ms);
    }
    std::printf(
        "  %-10s %d threads  %6.2f ms a frame, cpu %6.2f; ORB %5.2f ms, cpu %5.2f; "
        "ratio %5.2f, by cpu on %d idle cores %5.2f\n",
        way.name, threads, median(frame_ms), median(frame_cpu), median(orb_ms), median(orb_cpu),
        median(by_time), threads, median(by_cpu));
  }
  report_passes(scene, video, way);
}

int run(const std::vector<std::string>& arguments) {
  cv::setNumThreads(1);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::vector<Way> known = {
      {"simplified", true, false}, {"as-is", false, false}, {"opengl", true, true}};
  std::vector<Way> ways;
  std::string image;
  for (const std::string& argument : arguments) {
    const auto way = std::ranges::find_if(known, [&](const Way& w) { return argument == w.name; });
    if (way == known.end()) {
      image = argument;
    } else {
      ways.push_back(*way);
    }
  }
  const cv::Mat video = test_frame(image);
  for (const int triangles : {20000, 100000}) {
    const render::LayerScene scene = table_scene(bumpy_ball(triangles));
    std::printf("%d triangles, covering %.1f %% of 640x480\n", triangles,
                100.0 * covered_share(scene));
    for (const Way& way : ways.empty() ? known : ways) report(scene, video, way);
  }
  return 0;
}

}  // namespace
}  // namespace planecast::bench

int main(int argc, char** argv) { return planecast::bench::run({argv + 1, argv + argc}); }
