#include "engine/inspect/frame_pictures.h"

#include "engine/assets.h"
#include "engine/channels.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

const cv::Scalar kDark(34, 30, 27);

PainterOptions painter_options(const SceneFile& scene) {
  PainterOptions options;
  options.shader_dir = asset("shaders");
  options.placing.occlusion = scene.occlusion;
  options.placing.shadows = scene.shadows;
  options.look = scene.look;
  return options;
}

LightTrack light_of(const InspectSession& session, Sequence* sequence) {
  const Reconstruction& reconstruction = session.reconstruction();
  const std::optional<FixedLight>& fixed = session.scene().light;
  if (sequence == nullptr) {
    return LightTrack(fixed_light(fixed.value_or(FixedLight()), reconstruction.up));
  }
  LightTrackOptions options;
  options.most_samples = 12;  // a window shall open soon
  options.follow_exposure = session.scene().look.exposure;
  return {*sequence, reconstruction, fixed, options};
}

}  // namespace

FramePictures::FramePictures(const InspectSession& session, std::unique_ptr<Sequence> sequence)
    : session_(session),
      sequence_(std::move(sequence)),
      light_(light_of(session, sequence_.get())) {}

void FramePictures::read_frame() {
  if (read_position_ == session_.position()) return;
  read_position_ = session_.position();
  const slam::Camera& camera = session_.reconstruction().camera;
  frame_ = {};
  const int index = session_.frame().index;
  if (sequence_ && index >= sequence_->first_frame() && index < sequence_->end_frame()) {
    try {
      frame_ = sequence_->read(index);
    } catch (const UserError&) {
      frame_ = {};
    }
  }
  if (frame_.image.empty()) frame_.image = cv::Mat(camera.height, camera.width, CV_8UC3, kDark);
  frame_.index = index;
}

cv::Mat FramePictures::painted() {
  cv::Mat picture = to_bgr(frame_.image);
  const FrameRecord& record = session_.frame();
  if (!shown_objects_ || !record.world_from_cam || session_.content().items.empty()) return picture;
  if (!painter_) {
    painter_ = std::make_unique<FramePainter>(session_.reconstruction(), session_.content(), light_,
                                              painter_options(session_.scene()));
  } else if (painter_content_ != session_.revision()) {
    painter_->set_content(session_.content());
  }
  painter_content_ = session_.revision();
  const double time_s = record.timestamp - session_.reconstruction().frames.front().timestamp;
  painter_->paint(frame_, *record.world_from_cam, time_s, picture);
  return picture;
}

const cv::Mat& FramePictures::picture(bool with_objects) {
  const bool same = shown_position_ == session_.position() &&
                    shown_content_ == session_.revision() && shown_objects_ == with_objects;
  if (same && !picture_.empty()) return picture_;
  read_frame();
  shown_position_ = session_.position();
  shown_content_ = session_.revision();
  shown_objects_ = with_objects;
  picture_ = painted();
  ++revision_;
  return picture_;
}

}  // namespace planecast::engine
