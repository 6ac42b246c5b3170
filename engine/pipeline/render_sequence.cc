#include "engine/pipeline/render_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <sstream>

#include "engine/assets.h"
#include "engine/look/debug_overlay.h"
#include "engine/output/atomic_file.h"
#include "engine/output/match_move.h"
#include "engine/output/match_move_camera.h"
#include "engine/output/png.h"
#include "engine/output/video.h"
#include "engine/pipeline/frame_painter.h"
#include "engine/pipeline/picture_flow.h"
#include "engine/pipeline/scene_light.h"
#include "engine/scene/content.h"
#include "engine/user_error.h"

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
        content_(load_content({reconstruction, options.causal, markers_}, scene)),
        light_(sequence, reconstruction, scene.light, light_options()),
        painter_(reconstruction, content_, light_, painter_options()) {
    for (const FrameRecord& record : reconstruction.frames) records_[record.index] = &record;
    result_.warnings = content_.warnings;
    result_.units_per_metre = content_.units_per_metre;
    result_.renderer = painter_.renderer_description();
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
    result.seed = options_.seed;
    return result;
  }
  LightTrackOptions light_options() const {
    LightTrackOptions result;
    result.causal = options_.causal;
    result.follow_exposure = scene_.look.exposure;
    return result;
  }
  void open_outputs();
  std::string content_key() const;
  int resume_frame() const;
  void write(const Picture& picture);
  cv::Mat picture_of(const ReadFrame& job);
  void keep_still(int index, const cv::Mat& picture);

  Sequence& sequence_;
  const Reconstruction& reconstruction_;
  const SceneFile& scene_;
  const RenderSequenceOptions& options_;
  std::filesystem::path folder_;
  MarkerMap markers_;
  Content content_;
  LightTrack light_;
  FramePainter painter_;
  std::unique_ptr<DebugOverlay> overlay_;
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

/// Everything but the pictures' own content that a frame depends on.
std::string SequenceRenderer::content_key() const {
  std::string key = scene_.name.empty() ? "default scene" : read_file(scene_.name);
  key += "\nframes " + std::to_string(sequence_.first_frame()) + ":" +
         std::to_string(sequence_.end_frame());
  key += "\nseed " + std::to_string(options_.seed) + (options_.causal ? " causal" : "") +
         (options_.debug_overlay ? " overlay" : "");
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
  if (video_) video_->write(picture.bgr);
  if (!options_.png) return;
  char name[32];
  std::snprintf(name, sizeof(name), "%06d.png", picture.index);
  write_png(picture.bgr, folder_ / "frames" / name);
}

cv::Mat SequenceRenderer::picture_of(const ReadFrame& job) {
  if (!job.error.empty()) {
    result_.unreadable.push_back(job.index);
    if (!last_picture_.empty()) return last_picture_.clone();
    return cv::Mat::zeros(reconstruction_.camera.height, reconstruction_.camera.width, CV_8UC3);
  }
  cv::Mat picture = to_bgr(job.frame.image);
  const auto entry = records_.find(job.index);
  if (entry == records_.end()) return picture;
  const FrameRecord& record = *entry->second;
  const auto& pose = options_.causal ? record.causal_world_from_cam : record.world_from_cam;
  if (pose) {
    const double time_s = job.frame.timestamp - reconstruction_.frames.front().timestamp;
    result_.with_content += painter_.paint(job.frame, *pose, time_s, picture) ? 1 : 0;
    const PaintTimes& times = painter_.times();
    result_.frame_times[job.index] = {
        {"look", times.look_ms}, {"draw", times.draw_ms}, {"composite", times.composite_ms}};
  }
  if (options_.debug_overlay) {
    if (!overlay_) overlay_ = std::make_unique<DebugOverlay>(reconstruction_);
    overlay_->draw(record, options_.causal, picture);
  }
  return picture;
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
    while (const std::optional<ReadFrame> job = reader.next()) {
      if (!job->error.empty() && !options_.skip_unreadable) {
        fatal = job->error;
        break;
      }
      cv::Mat picture = picture_of(*job);
      last_picture_ = picture;
      keep_still(job->index, picture);
      writer.put({job->index, picture});
      ++result_.frames;
      if (progress) progress(job->index + 1 - sequence_.first_frame(), total);
    }
    writer.finish();
  }
  // Even then what came before is completed; a video of nothing cannot be.
  if (video_ && (result_.frames > 0 || fatal.empty())) video_->finish();
  if (!fatal.empty()) throw UserError(fatal);
  for (const auto& [frame, times] : result_.frame_times) {
    for (const auto& [step, ms] : times) result_.mean_ms[step] += ms / result_.frames;
  }
  return std::move(result_);
}

RenderSequenceResult SequenceRenderer::draw(const std::vector<int>& frames) {
  for (const int index : frames) {
    result_.stills.emplace_back(index, picture_of({index, sequence_.read(index), ""}));
    ++result_.frames;
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
