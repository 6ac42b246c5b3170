#include "engine/sequence/synth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <future>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "engine/assets.h"
#include "engine/cancel.h"
#include "engine/convert.h"
#include "engine/sequence/camera_file.h"
#include "engine/sequence/synth/camera_effects.h"
#include "engine/sequence/synth/lens.h"
#include "engine/sequence/synth/painted_scene.h"
#include "engine/sequence/synth/random.h"
#include "engine/sequence/synth/scenes.h"
#include "engine/sequence/synth/troubles.h"
#include "engine/sequence/synth/truth_files.h"
#include "engine/user_error.h"
#include "render/renderer.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

constexpr double kFarthestDepth = 8.0;  // metres: what a structured-light sensor still sees

CameraSettings synthetic_camera(const SynthOptions& options) {
  CameraSettings settings;
  settings.camera = synth::lens_camera(options.lens, options.width, options.height);
  settings.fps = options.fps;
  settings.depth_factor = options.depth_factor;
  return settings;
}

void check(const SynthOptions& options) {
  if (options.width < 16 || options.height < 16 || options.width > 4096 || options.height > 4096) {
    throw UserError(fmt::format("{}x{}: pictures must be 16 to 4096 pixels a side", options.width,
                                options.height));
  }
  if (!(options.fps > 0.0) || options.fps > 1000.0) {
    throw UserError(
        fmt::format("{} frames per second: must be above 0 and at most 1000", options.fps));
  }
  const std::vector<std::string> lenses = synth::lens_names();
  if (std::find(lenses.begin(), lenses.end(), options.lens) == lenses.end()) {
    throw UserError(
        fmt::format("{}: no such synthetic lens ({})", options.lens, fmt::join(lenses, ", ")));
  }
  const std::vector<std::string> troubles = synth::trouble_names();
  if (std::find(troubles.begin(), troubles.end(), options.trouble) == troubles.end()) {
    throw UserError(fmt::format("{}: no such trouble of a recording ({})", options.trouble,
                                fmt::join(troubles, ", ")));
  }
  if (!(options.depth_factor > 0.0)) throw UserError("the depth factor must be positive");
}

synth::Scene scene_named(const SynthOptions& options) {
  auto scene = synth::make_scene(options.name, options.seed);
  if (scene) return std::move(*scene);
  throw UserError(fmt::format("{}: no such synthetic scene ({})", options.name,
                              fmt::join(synth::scene_names(), ", ")));
}

synth::Scene troubled(synth::Scene scene, const synth::Trouble& trouble) {
  if (trouble.shutter_s > 0.0) scene.effects.shutter_s = trouble.shutter_s;
  scene.effects.exposure_jumps = trouble.exposure_jumps;
  return scene;
}

/// What a camera without faults sees: 8-bit BGR, 8-bit labels, CV_32F metres.
struct ExactPictures {
  cv::Mat bgr;
  cv::Mat mask;
  cv::Mat depth_m;
};

/// One frame as it will be written.
struct FramePictures {
  std::string stamp;
  cv::Mat bgr;
  cv::Mat depth;  ///< 16-bit
  cv::Mat mask;   ///< 8-bit
};

cv::Mat bgr_of(const render::ImageU8& rgb) {
  cv::Mat bgr(rgb.height, rgb.width, CV_8UC3);
  const std::uint8_t* from = rgb.pixels.data();
  for (int y = 0; y < bgr.rows; ++y) {
    auto* to = bgr.ptr<std::uint8_t>(y);
    for (int x = 0; x < bgr.cols; ++x, from += 3, to += 3) {
      to[0] = from[2];
      to[1] = from[1];
      to[2] = from[0];
    }
  }
  return bgr;
}

/// Labels as they are, but 0 for planes that face away: on an edge that two faces share, rounding
/// may show the one behind.
cv::Mat mask_of(const render::Image<std::uint16_t>& labels, const std::vector<char>& hidden) {
  cv::Mat mask(labels.height, labels.width, CV_8U);
  std::transform(labels.pixels.begin(), labels.pixels.end(), mask.begin<std::uint8_t>(),
                 [&hidden](std::uint16_t label) {
                   return static_cast<std::uint8_t>(hidden[label] != 0 ? 0 : label);
                 });
  return mask;
}

cv::Mat encode_depth(const cv::Mat& depth_m, double factor) {
  cv::Mat units(depth_m.size(), CV_16U);
  std::transform(depth_m.begin<float>(), depth_m.end<float>(), units.begin<std::uint16_t>(),
                 [factor](float z) -> std::uint16_t {
                   const double value = z > kFarthestDepth ? 0.0 : std::round(z * factor);
                   return static_cast<std::uint16_t>(value < 65535.0 ? value : 0.0);
                 });
  return units;
}

/// Pixels a second at which a point 2 m ahead of the camera moves.
Eigen::Vector2d flow_at(const synth::CameraPath& path, const slam::Camera& camera, double time_s) {
  constexpr double kStep = 1e-3;
  const slam::Pose now = path.world_from_cam(time_s);
  const slam::Pose later = path.world_from_cam(time_s + kStep);
  const Eigen::Vector3d ahead = now * Eigen::Vector3d(0, 0, 2.0);
  const Eigen::Vector2d moved = camera.project(later.inverse() * ahead);
  return (moved - Eigen::Vector2d(camera.cx, camera.cy)) / kStep;
}

bool is_covered(const synth::Scene& scene, double time_s) {
  return std::any_of(scene.covered_s.begin(), scene.covered_s.end(), [time_s](const auto& span) {
    return time_s >= span.first && time_s < span.second;
  });
}

class Generator {
 public:
  Generator(const SynthOptions& options, synth::Scene scene)
      : options_(options),
        trouble_(synth::trouble_named(options.trouble)),
        scene_(troubled(std::move(scene), trouble_)),
        camera_(synthetic_camera(options).camera),
        lens_(camera_),
        renderer_(renderer_options(options)),
        painted_(synth::paint_scene(scene_.model, texture_detail(options))),
        effects_(scene_.effects, options.width, options.height,
                 synth::named_seed("effects", options.seed)),
        passer_(synth::named_seed("passer", options.seed)) {}

  FramePictures draw(int frame, double time_s) {
    ExactPictures exact = trouble_.readout_s > 0.0 ? rolled(time_s) : at_once(time_s);
    FramePictures pictures;
    pictures.bgr = exact.bgr;
    pictures.mask = exact.mask;
    cv::Mat depth_m = exact.depth_m;
    if (is_covered(scene_, path_time(time_s))) {
      pictures.bgr = synth::covered_lens(camera_.width, camera_.height, frame, options_.seed);
      pictures.mask.setTo(0);
      depth_m.setTo(0.0F);
    } else if (options_.effects) {
      effects_.apply(pictures.bgr, frame, time_s,
                     trouble_.speed * flow_at(scene_.path, camera_, path_time(time_s)));
      synth::degrade_depth(depth_m, camera_.fx, frame, synth::named_seed("depth", options_.seed));
    }
    pictures.depth = encode_depth(depth_m, options_.depth_factor);
    return pictures;
  }

  const synth::Scene& scene() const { return scene_; }
  slam::Pose world_from_cam(double time_s) const {
    return scene_.path.world_from_cam(path_time(time_s));
  }
  double duration_s() const { return scene_.path.duration_s() / trouble_.speed; }
  bool is_dropped(int frame, double time_s) const {
    return synth::is_dropped(trouble_, frame, time_s, synth::named_seed("dropped", options_.seed));
  }

 private:
  double path_time(double time_s) const { return trouble_.speed * time_s; }
  /// As a global shutter sees it.
  ExactPictures at_once(double time_s) {
    const slam::Pose world_from_camera = world_from_cam(time_s);
    const slam::Pose cam_from_world = world_from_camera.inverse();
    const render::OpaqueImages images =
        renderer_.draw_opaque(painted_, to_render_camera(lens_.drawn_camera(), cam_from_world));
    cv::Mat bgr = bgr_of(images.rgb);
    cv::Mat mask = mask_of(images.labels, hidden_labels(world_from_camera));
    cv::Mat depth_m(images.depth.height, images.depth.width, CV_32F);
    std::copy(images.depth.pixels.begin(), images.depth.pixels.end(), depth_m.begin<float>());
    if (trouble_.passer) {
      passer_.draw(scene_.path, lens_.drawn_camera(), time_s, bgr, mask, depth_m);
    }
    return {lens_.warp_colors(bgr), lens_.warp_nearest(mask), lens_.warp_nearest(depth_m)};
  }
  /// Rows from one time after the other, the middle one's at `time_s`, in bands within which the
  /// picture moves by a fraction of a pixel.
  ExactPictures rolled(double time_s) {
    constexpr int kBands = 12;
    ExactPictures rolled;
    for (int band = 0; band < kBands; ++band) {
      const double share = (band + 0.5) / kBands - 0.5;
      const ExactPictures now = at_once(time_s + share * trouble_.readout_s);
      if (band == 0) rolled = {now.bgr.clone(), now.mask.clone(), now.depth_m.clone()};
      const cv::Range rows(band * now.bgr.rows / kBands, (band + 1) * now.bgr.rows / kBands);
      now.bgr.rowRange(rows).copyTo(rolled.bgr.rowRange(rows));
      now.mask.rowRange(rows).copyTo(rolled.mask.rowRange(rows));
      now.depth_m.rowRange(rows).copyTo(rolled.depth_m.rowRange(rows));
    }
    return rolled;
  }
  /// By label, whether its plane shows the camera its back.
  std::vector<char> hidden_labels(const slam::Pose& world_from_cam) const {
    std::vector<char> hidden(scene_.model.planes.size() + 1, 0);
    for (const synth::TruePlane& plane : scene_.model.planes) {
      const double side = plane.normal.dot(world_from_cam.translation()) + plane.offset;
      hidden[static_cast<std::size_t>(plane.label)] = side <= 0.0 ? 1 : 0;
    }
    return hidden;
  }
  static render::RendererOptions renderer_options(const SynthOptions& options) {
    render::RendererOptions renderer;
    renderer.shader_dir =
        options.shader_dir.empty() ? asset("shaders").string() : options.shader_dir;
    return renderer;
  }
  /// Small pictures need no large textures.
  static float texture_detail(const SynthOptions& options) {
    return static_cast<float>(std::clamp(options.width / 640.0, 0.08, 2.0));
  }

  const SynthOptions& options_;
  synth::Trouble trouble_;
  synth::Scene scene_;
  slam::Camera camera_;
  synth::LensWarp lens_;
  render::Renderer renderer_;
  render::OpaqueScene painted_;
  synth::CameraEffects effects_;
  synth::Passer passer_;
};

void write_png(const fs::path& file, const cv::Mat& image, int strategy) {
  bool good = false;
  try {
    good = cv::imwrite(file.string(), image,
                       {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY, strategy});
  } catch (const cv::Exception&) {
    good = false;
  }
  if (!good) throw UserError(file.string() + ": cannot be written");
}

void write_pictures(const fs::path& out, const FramePictures& pictures) {
  const std::string name = pictures.stamp + ".png";
  // In noise there is nothing to be found again: Huffman coding alone is smaller and quicker.
  write_png(out / "rgb" / name, pictures.bgr, cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY);
  write_png(out / "depth" / name, pictures.depth, cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY);
  write_png(out / "mask" / name, pictures.mask, cv::IMWRITE_PNG_STRATEGY_DEFAULT);
}

void make_folders(const fs::path& out) {
  for (const char* name : {"rgb", "depth", "mask"}) {
    std::error_code error;
    fs::create_directories(out / name, error);
    if (error) throw UserError(fmt::format("{}: {}", (out / name).string(), error.message()));
  }
}

}  // namespace

std::vector<std::string> synthetic_scene_names() { return synth::scene_names(); }
std::vector<std::string> synthetic_lens_names() { return synth::lens_names(); }
std::vector<std::string> synthetic_trouble_names() { return synth::trouble_names(); }

void write_synthetic(const SynthOptions& options, const fs::path& out,
                     const std::function<void(int, int)>& progress) {
  check(options);
  synth::Scene scene = scene_named(options);
  make_folders(out);
  Generator generator(options, std::move(scene));
  const int total = options.frames > 0
                        ? options.frames
                        : static_cast<int>(std::lround(generator.duration_s() * options.fps));
  synth::TruthFiles truth(out, generator.scene().model.planes);
  // Encoding takes as long as drawing: the frame before is written meanwhile.
  std::future<void> writing;
  int written = 0;
  for (int frame = 0; frame < total; ++frame) {
    throw_if_cancelled("the sequence is not complete, and has no list of its pictures yet");
    const double time_s = frame / options.fps;
    if (generator.is_dropped(frame, time_s)) continue;
    FramePictures pictures = generator.draw(frame, time_s);
    pictures.stamp = fmt::format("{:.6f}", time_s);
    truth.add_frame(pictures.stamp, written++, generator.world_from_cam(time_s), pictures.mask);
    if (writing.valid()) writing.get();
    writing = std::async(std::launch::async, write_pictures, out, std::move(pictures));
    if (progress) progress(frame + 1, total);
  }
  if (writing.valid()) writing.get();
  write_camera_file(out / "camera.yaml", synthetic_camera(options));
  truth.write();
}

}  // namespace planecast::engine
