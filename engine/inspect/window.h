#pragma once

#include <cstdint>
#include <vector>

#include "engine/gui/picture_marks.h"
#include "engine/inspect/map_camera.h"
#include "engine/inspect/map_drawing.h"
#include "engine/inspect/session.h"
#include "engine/output/tables.h"

namespace planecast::engine {

/// Texture number of the frame's picture (engine/gui/gui_context.h has the font's).
inline constexpr std::uintptr_t kFrameTexture = 2;

/// A part of the window, in pixels.
struct InspectRect {
  float x = 0.0F;
  float y = 0.0F;
  float width = 0.0F;
  float height = 0.0F;
};

/// Picture at the left over the timeline, map at the right over the tables.
struct InspectLayout {
  InspectRect picture;
  InspectRect timeline;
  InspectRect map;
  InspectRect tables;
};
InspectLayout inspect_layout(float width, float height);

/// What is shown; nothing of it is saved.
struct InspectView {
  bool planes = true;
  bool points = false;
  bool objects = true;
  bool boxes = true;  ///< of the objects
  bool playing = false;
  MapDrawingOptions map;
};

/// The inspector's panels. Draws the session with Dear ImGui between begin() and end() of a
/// GuiContext, and turns the input ImGui was given into the session's actions.
class InspectWindow {
 public:
  /// `timings` may be empty. `fps` is the speed of playing.
  InspectWindow(InspectSession& session, std::vector<TimingRow> timings, double fps);

  void draw();
  const InspectView& view() const { return view_; }
  InspectView& view() { return view_; }
  /// Where the last draw() put the picture.
  const PictureArea& picture_area() const { return area_; }
  const MapCamera& map_camera() const { return map_camera_; }
  bool wants_to_close() const { return wants_to_close_; }

 private:
  void keys();
  void play();
  void picture_panel(const InspectRect& rect);
  void toolbar();
  void picture_input(bool hovered);
  void marks(ImDrawList& list);
  void timeline_panel(const InspectRect& rect);
  void lane(float width, float height);
  void map_panel(const InspectRect& rect);
  void map_input();
  void tables_panel(const InspectRect& rect);
  void objects_table();
  void object_sliders();
  void planes_table();
  void frame_table();
  void timings_table();

  InspectSession& session_;
  std::vector<TimingRow> timings_;
  double fps_;
  MapCamera map_camera_;
  MapDrawing map_drawing_;
  InspectView view_;
  PictureArea area_;
  bool dragging_ = false;
  double play_time_s_ = 0.0;
  bool wants_to_close_ = false;
};

}  // namespace planecast::engine
