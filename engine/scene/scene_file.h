#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace planecast::engine {

/// A tap: where the ray of a raw input pixel meets a plane, at a frame of the whole sequence.
struct PixelPlace {
  int frame = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< raw input pixel
};

/// A point of a plane given by its id or a rule (largest-horizontal, largest-vertical, floor,
/// nearest).
struct PlanePlace {
  std::string plane;                                    ///< id in decimals, or the rule's name
  Eigen::Vector2d at = Eigen::Vector2d::Constant(0.5);  ///< fraction of the bounding rectangle
};

/// A point of the world, tied to no plane.
struct PointPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of the imagined ground; zero: world's up
};

using Place = std::variant<PixelPlace, PlanePlace, PointPlace>;

enum class Face {
  kCamera,  ///< the model's front turns to the placing camera, once
  kKeep,    ///< the model's x axis stays along the plane's x axis
};

struct SceneObject {
  std::filesystem::path model;  ///< existing file
  Place place;
  std::optional<double>
      size;              ///< longest side: metres where the scale is known, else x the median depth
  double yaw_deg = 0.0;  ///< about the plane's normal, counter-clockwise seen from its side
  Face face = Face::kCamera;
  std::string animation;  ///< name; empty: see the index
  std::optional<int> animation_index;
  std::string where;  ///< "file:LINE" for messages
};

/// Sun and sky in a frame with y up, x to the first camera's right and z towards the viewer.
struct FixedLight {
  Eigen::Vector3d sun_direction = {0.3, 0.9, 0.3};                ///< towards the sun
  Eigen::Vector3d sun_radiance = Eigen::Vector3d::Constant(1.0);  ///< linear RGB
  Eigen::Vector3d sky_radiance = Eigen::Vector3d::Constant(0.5);  ///< linear RGB
};

enum class Occlusion { kNone, kPlanes, kDepth, kBoth };

/// The length of something gives metres to a map that has none.
struct PlaneDistanceScale {
  double distance_m = 0.0;  ///< from the camera to the plane of the first object, at right angles
  std::optional<int>
      frame;  ///< default: the first object's placing frame, else the first with a pose
};
struct EdgeScale {
  double length_m = 0.0;  ///< between the points under two pixels of a frame
  int frame = 0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};
struct ScaleHint {
  std::variant<PlaneDistanceScale, EdgeScale> rule;
  std::string where;
};

struct SceneFile {
  std::string name;                 ///< as given, for messages; empty: made without a file
  std::optional<FixedLight> light;  ///< nothing: estimated from the pictures
  bool shadows = true;
  Occlusion occlusion = Occlusion::kPlanes;
  std::vector<SceneObject> objects;
  std::optional<ScaleHint> scale;
};

/// Reads a scene file (design.md section 4). Relative model paths are looked up beside the file,
/// then in the current folder. Throws UserError "file:LINE: reason" for anything it does not know.
SceneFile read_scene_file(const std::filesystem::path& path);

}  // namespace planecast::engine
