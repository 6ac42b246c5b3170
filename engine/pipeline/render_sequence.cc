#include "engine/pipeline/render_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>

#include "engine/assets.h"
#include "engine/cancel.h"
#include "engine/channels.h"
#include "engine/look/debug_overlay.h"
#include "engine/output/atomic_file.h"
#include "engine/output/match_move.h"
#include "engine/output/match_move_camera.h"
#include "engine/output/png.h"
#include "engine/output/video.h"
#include "engine/pipeline/frame_painter.h"
#include "engine/pipeline/painting_threads.h"
#include "engine/pipeline/picture_flow.h"
#include "engine/pipeline/scene_light.h"
#include "engine/program.h"
#include "engine/scene/content.h"
#include "engine/user_error.h"
#include "render/gltf/polished.h"
#include "slam/data/byte_stream.h"

namespace planecast::engine {
namespace {

void check_size(const Sequence& sequence, const Reconstruction& reconstruction) {
  const slam::Camera& frames = sequence.camera();
  const slam::Camera& map = reconstruction.camera;
  if (frames.width == map.width && frames.height == map.height) return;
  throw UserError(fmt::format("{}: frames of {}x{} do not fit the reconstruction's {}x{}",
                              sequence.path().string(), frames.width, frames.height, map.width,
                              map.height));
}

class SequenceRenderer {
 public:
  SequenceRenderer(Sequence& sequence, const Reconstruction& reconstruction, const SceneFile& scene,
                   const RenderSequenceOptions& options, const std::filesystem::path& folder)
      : sequence_(sequence),
        reconstruction_(reconstruction),
        scene_(scene),
        options_(options),
        folder_(folder),
        markers_(find_markers(sequence, reconstruction, markers_of(scene))),
        content_(load_content({reconstruction, options.causal, markers_}, scene,
                              options.models != nullptr ? *options.models : own_models_)),
        light_(sequence, reconstruction, scene.light, light_options()) {
    for (const FrameRecord& record : reconstruction.frames) records_[record.index] = &record;
    result_.warnings = content_.warnings;
    result_.units_per_metre = content_.units_per_metre;
    result_.objects = object_records(content_, reconstruction);
  }

  RenderSequenceResult run(const Progress& progress);
  RenderSequenceResult draw(const std::vector<int>& frames);

 private:
  PainterOptions painter_options() const {
    PainterOptions result;
    result.shader_dir = asset("shaders");
    result.placing.causal = options_.causal;
    result.placing.ease_frames = scene_.ease_frames;
    result.placing.occlusion = scene_.occlusion;
    result.placing.shadows = scene_.shadows;
    result.look = scene_.look;
    result.only_opengl = options_.only_opengl;
    result.seed = options_.seed;
    return result;
  }
  LightTrackOptions light_options() const {
    LightTrackOptions result;
    result.causal = options_.causal;
    result.threads = options_.threads;
    result.follow_exposure = scene_.look.exposure;
    result.reflections = std::ranges::any_of(content_.items, [](const ContentItem& item) {
      return item.model != nullptr && render::is_polished(*item.model);
    });
    return result;
  }
  void open_outputs();
  std::string content_key() const;
  int resume_frame() const;
  void write(const Picture& picture);
  PaintingThreads::Paint make_painter() const;
  PaintedFrame painted(FramePainter& painter, DebugOverlay* overlay, const ReadFrame& job) const;
  void take(PaintedFrame& frame);
  void keep_still(int index, const cv::Mat& picture);

  Sequence& sequence_;
  const Reconstruction& reconstruction_;
  const SceneFile& scene_;
  const RenderSequenceOptions& options_;
  std::filesystem::path folder_;
  MarkerMap markers_;
  ModelShelf own_models_;
  Content content_;
  LightTrack light_;
  std::map<int, const FrameRecord*> records_;
  std::unique_ptr<VideoWriter> video_;
  std::vector<int> still_frames_;
  cv::Mat last_picture_;
  RenderSequenceResult result_;
};

void SequenceRenderer::open_outputs() {
  make_folder(folder_);
  write_match_move(reconstruction_, folder_ / "scene.glb", result_.objects);
  write_chan(reconstruction_, folder_ / "camera.chan");
  if (options_.png) make_folder(folder_ / "frames");
  if (options_.video) {
    VideoOptions video_options;
    video_options.resume = options_.resume;
    video_options.content_key = content_key();
    result_.video = folder_ / "augmented.mp4";
    video_ = std::make_unique<VideoWriter>(result_.video, reconstruction_.camera.width,
                                           reconstruction_.camera.height, sequence_.fps(),
                                           video_options);
  }
}

/// Everything but the pictures' own content that a frame depends on. Models and poses count by
/// their bytes, which a file's name does not tell.
std::string SequenceRenderer::content_key() const {
  std::string key = "program " + program_key() + "\n";
  key += scene_.name.empty() ? "default scene" : read_file(scene_.name);
  for (const SceneObject& object : scene_.objects) {
    const std::filesystem::path& file = object.poster ? object.poster->file : object.model;
    key += fmt::format("\nmodel {:016x}", slam::checksum_of(read_file(file)));
  }
  slam::ByteWriter poses;
  for (const FrameRecord& record : reconstruction_.frames) {
    const auto& pose = options_.causal ? record.causal_world_from_cam : record.world_from_cam;
    const Eigen::Matrix4d matrix = pose.value_or(slam::Pose::Identity()).matrix();
    for (const double value : matrix.reshaped()) poses.put(value);
  }
  key += fmt::format("\nsequence {}\nposes {:016x}",
                     std::filesystem::absolute(sequence_.path()).lexically_normal().string(),
                     slam::checksum_of(poses.bytes()));
  key += "\nframes " + std::to_string(sequence_.first_frame()) + ":" +
         std::to_string(sequence_.end_frame());
  key += "\nseed " + std::to_string(options_.seed) + (options_.causal ? " causal" : "") +
         (options_.debug_overlay ? " overlay" : "") + (options_.only_opengl ? " opengl" : "");
  for (const ContentItem& item : content_.items) {
    const Eigen::Matrix4d pose = item.placed.anchor.plane_from_anchor.matrix();
    std::ostringstream numbers;
    numbers << std::hexfloat << pose.reshaped().transpose() << ' ' << item.placed.scale;
    key += "\nplane " + std::to_string(item.placed.anchor.plane_id) + " at " + numbers.str();
  }
  return key;
}

/// First frame that is still to be drawn.
int SequenceRenderer::resume_frame() const {
  const int first = sequence_.first_frame();
  if (!options_.resume || !video_) return first;
  return std::min(first + video_->first_missing_frame(), sequence_.end_frame());
}

void SequenceRenderer::write(const Picture& picture) {
  // First: the picture of a frame whose segment is complete is not drawn again.
  if (options_.png) {
    write_png(picture.bgr, folder_ / "frames" / fmt::format("{:06d}.png", picture.index));
  }
  if (video_) video_->write(picture.bgr);
}

/// A painter of its own for each thread that paints: rendering contexts belong to one.
PaintingThreads::Paint SequenceRenderer::make_painter() const {
  const auto painter =
      std::make_shared<FramePainter>(reconstruction_, content_, light_, painter_options());
  std::shared_ptr<DebugOverlay> overlay;
  if (options_.debug_overlay) overlay = std::make_shared<DebugOverlay>(reconstruction_);
  return [this, painter, overlay](const ReadFrame& job) {
    return painted(*painter, overlay.get(), job);
  };
}

PaintedFrame SequenceRenderer::painted(FramePainter& painter, DebugOverlay* overlay,
                                       const ReadFrame& job) const {
  PaintedFrame result;
  result.index = job.index;
  result.renderer = painter.renderer_description();
  result.readable = job.error.empty();
  if (!result.readable) return result;
  result.bgr = to_bgr(job.frame.image);
  const auto entry = records_.find(job.index);
  if (entry == records_.end()) return result;
  const FrameRecord& record = *entry->second;
  const auto& pose = options_.causal ? record.causal_world_from_cam : record.world_from_cam;
  if (pose) {
    const double time_s = job.frame.timestamp - reconstruction_.frames.front().timestamp;
    result.has_content = painter.paint(job.frame, *pose, time_s, result.bgr);
    result.by_processor = result.has_content && painter.by_processor();
    const PaintTimes& times = painter.times();
    result.times = {
        {"look", times.look_ms}, {"draw", times.draw_ms}, {"composite", times.composite_ms}};
  }
  if (overlay != nullptr) overlay->draw(record, options_.causal, result.bgr);
  return result;
}

/// Counts the frame; one that could not be read shows the last picture again.
void SequenceRenderer::take(PaintedFrame& frame) {
  if (!frame.readable) {
    result_.unreadable.push_back(frame.index);
    frame.bgr = last_picture_.empty() ? cv::Mat::zeros(reconstruction_.camera.height,
                                                       reconstruction_.camera.width, CV_8UC3)
                                      : last_picture_;
  }
  last_picture_ = frame.bgr;
  if (!frame.renderer.empty()) result_.renderer = frame.renderer;
  result_.with_content += frame.has_content ? 1 : 0;
  result_.by_processor += frame.by_processor ? 1 : 0;
  if (!frame.times.empty()) result_.frame_times[frame.index] = std::move(frame.times);
  ++result_.frames;
}

void SequenceRenderer::keep_still(int index, const cv::Mat& picture) {
  if (std::ranges::find(still_frames_, index) == still_frames_.end()) return;
  result_.stills.emplace_back(index, picture.clone());
}

RenderSequenceResult SequenceRenderer::run(const Progress& progress) {
  open_outputs();
  const int begin = resume_frame();
  const int end = sequence_.end_frame();
  const int total = end - sequence_.first_frame();
  for (int i = 0; i < options_.stills; ++i) {
    still_frames_.push_back(sequence_.first_frame() + (2 * i + 1) * total / (2 * options_.stills));
  }
  std::string fatal;
  {
    const bool threaded = options_.threads > 1;
    FrameReader reader(sequence_, begin, end, threaded);
    PictureWriter writer([this](const Picture& picture) { write(picture); }, threaded);
    PaintingThreads painters([this] { return make_painter(); }, options_.threads);
    for (bool more = true; more || !painters.empty();) {
      while (more && !painters.full()) {
        result_.interrupted = cancel_requested();
        std::optional<ReadFrame> job = result_.interrupted ? std::nullopt : reader.next();
        more = job && (job->error.empty() || options_.skip_unreadable);
        if (job && !more) fatal = job->error;
        if (more) painters.put(std::move(*job));
      }
      if (painters.empty()) break;
      PaintedFrame frame = painters.take();
      const int done = frame.index + 1 - sequence_.first_frame();
      take(frame);
      keep_still(frame.index, frame.bgr);
      writer.put({frame.index, frame.bgr});
      if (progress) progress(done, total);
    }
    writer.finish();
  }
  if (result_.interrupted) return std::move(result_);
  // Even then what came before is completed; a video of nothing cannot be.
  if (video_ && (result_.frames > 0 || fatal.empty())) video_->finish();
  if (!fatal.empty()) throw UserError(fatal);
  for (const auto& [frame, times] : result_.frame_times) {
    for (const auto& [step, ms] : times) result_.mean_ms[step] += ms / result_.frames;
  }
  return std::move(result_);
}

RenderSequenceResult SequenceRenderer::draw(const std::vector<int>& frames) {
  const PaintingThreads::Paint paint = make_painter();
  for (const int index : frames) {
    throw_if_cancelled();
    PaintedFrame frame = paint({index, sequence_.read(index), ""});
    take(frame);
    result_.stills.emplace_back(index, frame.bgr);
  }
  return std::move(result_);
}

}  // namespace

RenderSequenceResult render_sequence(Sequence& sequence, const Reconstruction& reconstruction,
                                     const SceneFile& scene, const RenderSequenceOptions& options,
                                     const std::filesystem::path& folder,
                                     const Progress& progress) {
  check_size(sequence, reconstruction);
  return SequenceRenderer(sequence, reconstruction, scene, options, folder).run(progress);
}

RenderSequenceResult draw_frames(Sequence& sequence, const Reconstruction& reconstruction,
                                 const SceneFile& scene, const RenderSequenceOptions& options,
                                 const std::vector<int>& frames) {
  check_size(sequence, reconstruction);
  return SequenceRenderer(sequence, reconstruction, scene, options, {}).draw(frames);
}

}  // namespace planecast::engine
