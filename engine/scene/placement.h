#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/markers.h"
#include "engine/scene/metric_scale.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/tap_motion.h"

namespace planecast::engine {

/// Where content is held: a pose in a plane's own frame, so that refinements, loop closures and
/// merges of the plane carry it. Without a plane (kNone) the pose is in the world.
///
/// The anchor's axes are those of the model: y up, z to the front. Its origin is the contact point.
struct Anchor {
  int plane_id = slam::kNone;
  slam::Pose plane_from_anchor = slam::Pose::Identity();

  /// The anchor in the world, by the present state of its plane. A plane that was merged away is
  /// found by its old id. Nothing when the plane is gone altogether.
  std::optional<slam::Pose> world_from_anchor(const std::vector<PlaneRecord>& planes) const;
};

/// The same place expressed in another plane's frame, as when `from` merges into `to`.
Anchor move_anchor(const Anchor& anchor, const PlaneRecord& from, const PlaneRecord& to);

/// A model's bounds in its own space: y up, metres.
using ModelBox = Eigen::AlignedBox3d;

struct PlacedObject {
  Anchor anchor;
  double scale = 1.0;                                 ///< world units per model unit
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();  ///< model point that sits on the anchor
  std::optional<Tap> tap;                             ///< where it was put by one
  bool hangs = false;                                 ///< with its back to a wall
  Eigen::Vector3d sides = Eigen::Vector3d::Zero();    ///< of its bounds, world units, model's axes

  /// Nothing when the anchor's plane is gone.
  std::optional<Eigen::Affine3d> world_from_model(const std::vector<PlaneRecord>& planes) const;
  /// With the anchor's plane at that pose (the identity for an anchor in the world).
  Eigen::Affine3d world_from_model(const slam::Pose& world_from_plane) const;
};

/// What places are looked up in.
struct PlacingWorld {
  const Reconstruction& map;
  bool causal = false;  ///< poses and planes as they were known at the placing frame
  const MarkerMap& markers;
};

/// Puts a model on its plane. On a plane that is not vertical the model stands: bottom centre of
/// its bounds on the place, y along the plane's normal, front (+z) towards the placing camera (or,
/// for a place by plane, the mean camera) when `face` is camera. On a vertical plane it hangs,
/// whatever it is: centre of its back on the place, +z along the normal, y along the world's up. A
/// plane is taken as vertical by its class, or, when it has none, by its angle to a known up
/// direction. `yaw` turns about the normal. On another object (`below`) it stands on that one's top
/// and faces as it does. Without `size` a model has its own size where the scale is known, else a
/// quarter of the median depth. Throws UserError beginning with the object's place in the file.
PlacedObject place_object(const PlacingWorld& world, const SceneObject& object, const ModelBox& box,
                          const SizeUnit& unit, const PlacedObject* below = nullptr);

/// World units per unit of the object's lengths. Throws UserError where it insists on metres and
/// there are none.
double length_unit(const SceneObject& object, const SizeUnit& unit);

/// The plane that a rule or id names. Throws UserError beginning with `where`.
const PlaneRecord& select_plane(const Reconstruction& reconstruction, const std::string& rule,
                                const std::string& where);

/// A marker that was found. Throws UserError beginning with `where`.
const FoundMarker& select_marker(const MarkerMap& markers, const MarkerId& marker,
                                 const std::string& where);

/// Mean position of the cameras that have a final pose; zero when none has.
Eigen::Vector3d mean_camera_position(const Reconstruction& reconstruction);

/// Whether content hangs on a plane rather than stands on it.
bool is_vertical(const Reconstruction& reconstruction, const PlaneRecord& plane);

}  // namespace planecast::engine
