#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/content.h"
#include "engine/scene/scene_file.h"

namespace planecast::engine {

/// What a click into the picture does.
enum class InspectTool {
  kMove,   ///< selects the object under the pointer, and drags it
  kPlace,  ///< puts the chosen model there
};

/// What the inspector works on and shows, and all that a user can do to it, without a window: every
/// action is a function here, and what was done to the scene can be undone. Frames are counted by
/// their position in the reconstruction.
class InspectSession {
 public:
  /// `scene_path` is where save() writes. `models` are offered for placing,
  /// `markers` are those found in the pictures. A scene whose objects
  /// have no place in this reconstruction throws UserError.
  InspectSession(Reconstruction reconstruction, SceneFile scene, std::filesystem::path scene_path,
                 std::vector<std::filesystem::path> models, MarkerMap markers = {});

  const Reconstruction& reconstruction() const { return reconstruction_; }
  const SceneFile& scene() const { return scene_; }
  const Content& content() const { return content_; }
  const std::vector<ObjectRecord>& objects() const { return objects_; }
  const std::vector<std::filesystem::path>& models() const { return models_; }
  const std::filesystem::path& scene_path() const { return scene_path_; }
  /// Grows with every change of the content.
  int revision() const { return revision_; }
  bool unsaved() const { return unsaved_; }
  /// What the last action has to say; empty when nothing.
  const std::string& message() const { return message_; }

  // The frame.
  int position() const { return position_; }
  int frame_count() const { return static_cast<int>(reconstruction_.frames.size()); }
  const FrameRecord& frame() const;
  void go_to(int position);
  void step(int frames) { go_to(position_ + frames); }
  /// To the frame with that index, or the last one before it.
  void go_to_frame(int index);

  // What is chosen.
  InspectTool tool = InspectTool::kMove;
  int model = 0;  ///< of models(), for placing
  std::optional<std::size_t> selected() const { return selected_; }
  void select(std::optional<std::size_t> object);
  /// The object whose box is hit by the ray of a raw pixel of the present frame, if any.
  std::optional<std::size_t> object_at(const Eigen::Vector2d& pixel) const;
  /// The plane that a tap there would meet, or kNone.
  int plane_at(const Eigen::Vector2d& pixel) const;
  int chosen_plane() const { return chosen_plane_; }
  void choose_plane(int id) { chosen_plane_ = id; }

  // Editing. Each returns whether the scene was changed; when not, message() says why.
  /// By the tool: places a model, or selects what is there.
  bool click(const Eigen::Vector2d& pixel);
  bool place(const Eigen::Vector2d& pixel);
  /// Moves the selected object to where a tap at that pixel would put it. Steps of one drag are
  /// undone together: call begin_drag() before the first.
  bool drag_to(const Eigen::Vector2d& pixel);
  void begin_drag() { remember({scene_.objects, selected_}); }
  /// Longest side in the scene file's unit: metres, or the share of the median depth.
  double selected_size() const;
  bool set_size(double size);
  bool scale_by(double factor) { return set_size(factor * selected_size()); }
  bool set_yaw(double degrees);
  bool rotate_by(double degrees);
  bool remove_selected();
  bool undo();
  bool redo();
  /// Writes the scene file.
  bool save();

 private:
  struct Step {
    std::vector<SceneObject> objects;
    std::optional<std::size_t> selected;
  };

  bool try_objects(std::vector<SceneObject> objects);
  bool change_selected(const SceneObject& object);
  void refresh(const SceneFile& scene);
  void remember(const Step& before);
  bool go_back(std::vector<Step>& from, std::vector<Step>& to);
  bool say(const std::string& message);

  Reconstruction reconstruction_;
  SceneFile scene_;
  std::filesystem::path scene_path_;
  std::vector<std::filesystem::path> models_;
  MarkerMap markers_;
  ModelShelf shelf_;
  Content content_;
  std::vector<ObjectRecord> objects_;
  std::vector<Step> done_;
  std::vector<Step> undone_;
  std::optional<std::size_t> selected_;
  std::string message_;
  int position_ = 0;
  int chosen_plane_ = slam::kNone;
  int revision_ = 0;
  bool unsaved_ = false;
};

}  // namespace planecast::engine
