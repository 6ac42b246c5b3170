#include "engine/inspect/session.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/scene/hit_test.h"
#include "engine/scene/metric_scale.h"
#include "engine/scene/write_scene_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr const char* kWhere = "object";  ///< how messages call what is being placed
constexpr std::size_t kMostSteps = 200;   ///< that can be undone
constexpr double kSmallestSize = 1e-4;
constexpr double kFinestYaw = 1e-3;  ///< degrees; keeps the file's numbers short

/// Depth at which a ray enters a box given in its own space; nothing when it passes by.
std::optional<double> entry_depth(const ObjectRecord& object, const Ray& ray) {
  const Eigen::Affine3d model_from_world = object.world_from_model.inverse();
  const Eigen::Vector3d origin = model_from_world * ray.origin;
  const Eigen::Vector3d direction = model_from_world.linear() * ray.direction;
  double enter = 0.0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) {
      const bool beside =
          origin[axis] < object.box.min()[axis] || origin[axis] > object.box.max()[axis];
      if (beside) return std::nullopt;
      continue;
    }
    double near = (object.box.min()[axis] - origin[axis]) / direction[axis];
    double far = (object.box.max()[axis] - origin[axis]) / direction[axis];
    if (near > far) std::swap(near, far);
    enter = std::max(enter, near);
    leave = std::min(leave, far);
  }
  return enter <= leave ? std::optional(enter) : std::nullopt;
}

/// Whole hundredths of a pixel: as fine as a pointer, and short in the file.
Eigen::Vector2d rounded(const Eigen::Vector2d& pixel) {
  return {std::round(pixel.x() * 100.0) / 100.0, std::round(pixel.y() * 100.0) / 100.0};
}

double turned(double degrees) {
  const double within = std::remainder(degrees, 360.0);
  return std::round(within / kFinestYaw) * kFinestYaw;
}

}  // namespace

InspectSession::InspectSession(Reconstruction reconstruction, SceneFile scene,
                               std::filesystem::path scene_path,
                               std::vector<std::filesystem::path> models, MarkerMap markers)
    : reconstruction_(std::move(reconstruction)),
      scene_path_(std::move(scene_path)),
      models_(std::move(models)),
      markers_(std::move(markers)) {
  refresh(scene);
  const auto posed = std::ranges::find_if(
      reconstruction_.frames, [](const FrameRecord& f) { return f.world_from_cam.has_value(); });
  if (posed != reconstruction_.frames.end()) {
    position_ = static_cast<int>(posed - reconstruction_.frames.begin());
  }
}

const FrameRecord& InspectSession::frame() const {
  return reconstruction_.frames.at(static_cast<std::size_t>(position_));
}

void InspectSession::go_to(int position) {
  position_ = std::clamp(position, 0, std::max(frame_count() - 1, 0));
}

void InspectSession::go_to_frame(int index) {
  const auto after = std::ranges::upper_bound(reconstruction_.frames, index, {},
                                              [](const FrameRecord& f) { return f.index; });
  go_to(static_cast<int>(after - reconstruction_.frames.begin()) - 1);
}

void InspectSession::select(std::optional<std::size_t> object) {
  selected_ = object && *object < scene_.objects.size() ? object : std::nullopt;
}

std::optional<std::size_t> InspectSession::object_at(const Eigen::Vector2d& pixel) const {
  if (frame_count() == 0 || !frame().world_from_cam) return std::nullopt;
  const Ray ray = pixel_ray(reconstruction_.camera, *frame().world_from_cam, pixel);
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const std::optional<double> depth = entry_depth(objects_[i], ray);
    if (!depth || *depth >= least) continue;
    least = *depth;
    nearest = i;
  }
  return nearest;
}

int InspectSession::plane_at(const Eigen::Vector2d& pixel) const {
  if (frame_count() == 0 || !frame().world_from_cam) return slam::kNone;
  const auto hit = hit_test(reconstruction_.planes,
                            pixel_ray(reconstruction_.camera, *frame().world_from_cam, pixel));
  return hit ? hit->plane_id : slam::kNone;
}

bool InspectSession::click(const Eigen::Vector2d& pixel) {
  message_.clear();
  if (tool == InspectTool::kPlace) return place(pixel);
  select(object_at(pixel));
  chosen_plane_ = selected_ ? slam::kNone : plane_at(pixel);
  return false;
}

bool InspectSession::place(const Eigen::Vector2d& pixel) {
  if (models_.empty() || frame_count() == 0) return say("there is no model to place");
  SceneObject object;
  object.model =
      models_[static_cast<std::size_t>(std::clamp(model, 0, static_cast<int>(models_.size()) - 1))];
  object.place = PixelPlace{frame().index, rounded(pixel)};
  object.where = kWhere;
  std::vector<SceneObject> objects = scene_.objects;
  objects.push_back(object);
  const Step before{scene_.objects, selected_};
  if (!try_objects(std::move(objects))) return false;
  remember(before);
  selected_ = scene_.objects.size() - 1;
  tool = InspectTool::kMove;
  return true;
}

bool InspectSession::drag_to(const Eigen::Vector2d& pixel) {
  if (!selected_) return say("no object is selected");
  SceneObject object = scene_.objects[*selected_];
  object.place = PixelPlace{frame().index, rounded(pixel)};
  std::vector<SceneObject> objects = scene_.objects;
  objects[*selected_] = std::move(object);
  return try_objects(std::move(objects));
}

double InspectSession::selected_size() const {
  if (!selected_) return 0.0;
  const SceneObject& object = scene_.objects[*selected_];
  if (object.size) return *object.size;
  const SizeUnit unit = size_unit({reconstruction_, false, markers_}, scene_, object);
  const double one = length_unit(object, unit);
  return content_.items[*selected_].longest_side / one;
}

bool InspectSession::set_size(double size) {
  if (!selected_) return say("no object is selected");
  SceneObject object = scene_.objects[*selected_];
  object.size = std::max(size, kSmallestSize);
  return change_selected(object);
}

bool InspectSession::set_yaw(double degrees) {
  if (!selected_) return say("no object is selected");
  SceneObject object = scene_.objects[*selected_];
  object.yaw_deg = turned(degrees);
  return change_selected(object);
}

bool InspectSession::rotate_by(double degrees) {
  return set_yaw(selected_ ? scene_.objects[*selected_].yaw_deg + degrees : 0.0);
}

bool InspectSession::remove_selected() {
  if (!selected_) return say("no object is selected");
  std::vector<SceneObject> objects = scene_.objects;
  objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(*selected_));
  const Step before{scene_.objects, selected_};
  if (!try_objects(std::move(objects))) return false;
  remember(before);
  selected_.reset();
  return true;
}

bool InspectSession::undo() { return go_back(done_, undone_) || say("nothing to undo"); }
bool InspectSession::redo() { return go_back(undone_, done_) || say("nothing to redo"); }

bool InspectSession::save() {
  if (scene_.objects.empty()) return say("a scene needs at least one object");
  try {
    write_scene_file(scene_, scene_path_);
  } catch (const UserError& error) {
    return say(error.what());
  }
  unsaved_ = false;
  message_ = "saved " + scene_path_.filename().string();
  return true;
}

bool InspectSession::change_selected(const SceneObject& object) {
  std::vector<SceneObject> objects = scene_.objects;
  objects[*selected_] = object;
  return try_objects(std::move(objects));
}

/// Nothing changes where one of the objects has no place.
bool InspectSession::try_objects(std::vector<SceneObject> objects) {
  SceneFile changed = scene_;
  changed.objects = std::move(objects);
  try {
    refresh(changed);
  } catch (const UserError& error) {
    return say(error.what());
  }
  unsaved_ = true;
  message_.clear();
  return true;
}

void InspectSession::refresh(const SceneFile& scene) {
  content_ = load_content({reconstruction_, false, markers_}, scene, shelf_);
  scene_ = scene;
  objects_ = object_records(content_, reconstruction_);
  ++revision_;
}

void InspectSession::remember(const Step& before) {
  if (done_.size() == kMostSteps) done_.erase(done_.begin());
  done_.push_back(before);
  undone_.clear();
}

bool InspectSession::go_back(std::vector<Step>& from, std::vector<Step>& to) {
  if (from.empty()) return false;
  const Step step = from.back();
  from.pop_back();
  to.push_back({scene_.objects, selected_});
  try_objects(step.objects);
  select(step.selected);
  return true;
}

bool InspectSession::say(const std::string& message) {
  message_ = message;
  return false;
}

}  // namespace planecast::engine
