#pragma once

#include <Eigen/Core>
#include <compare>
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

/// One printed marker of OpenCV's aruco dictionaries.
struct MarkerId {
  std::string dictionary;  ///< "4x4_50", ..., "7x7_1000", "original", "apriltag_36h11"
  int id = 0;
  auto operator<=>(const MarkerId&) const = default;
};

/// On a marker that lies in the scene.
struct MarkerPlace {
  MarkerId marker;
};

/// On top of an object that stands earlier in the list.
struct ObjectPlace {
  std::string object;  ///< its name
};

using Place = std::variant<PixelPlace, PlanePlace, PointPlace, MarkerPlace, ObjectPlace>;

enum class Face {
  kCamera,  ///< the model's front turns to the placing camera, once
  kKeep,    ///< the model's x axis stays along the plane's x axis
};

/// What lengths of an object count in.
enum class LengthUnit {
  kBest,      ///< metres where the scale is known, else the median depth
  kMetres,    ///< metres; an error where the scale is not known
  kRelative,  ///< the median depth, always
};

/// A picture or a looping video as a flat print.
struct Poster {
  std::filesystem::path file;  ///< existing file
  bool video = false;
};

struct SceneObject {
  std::string name;             ///< for others to stand on; may be empty
  std::filesystem::path model;  ///< existing file; empty: a poster
  std::optional<Poster> poster;
  Place place;
  /// Moves the object from its place along its own axes (x right, y up, z front), in `unit`.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::optional<double> size;  ///< longest side (of a poster: its width), in `unit`
  LengthUnit unit = LengthUnit::kBest;
  double yaw_deg = 0.0;  ///< about the plane's normal, counter-clockwise seen from its side
  Face face = Face::kCamera;
  std::string animation;  ///< name; empty: see the index
  std::optional<int> animation_index;
  bool loop = true;      ///< false: the animation, or the video, stops at its end
  double start_s = 0.0;  ///< time of the animation, or the video, at the first frame
  std::string where;     ///< "file:LINE" for messages
};

/// Sun and sky in a frame with y up, x to the first camera's right and z towards the viewer.
struct FixedLight {
  Eigen::Vector3d sun_direction = {0.3, 0.9, 0.3};                ///< towards the sun
  Eigen::Vector3d sun_radiance = Eigen::Vector3d::Constant(1.0);  ///< linear RGB
  Eigen::Vector3d sky_radiance = Eigen::Vector3d::Constant(0.5);  ///< linear RGB
};

enum class Occlusion { kNone, kPlanes, kDepth, kBoth };

/// What makes objects belong to the picture, each to be switched off.
struct Look {
  bool grain = true;
  bool blur = true;
  bool exposure = true;
  bool lens = true;         ///< objects bend with the camera's lens
  bool clean_edges = true;  ///< depth occlusion is guided by the picture
};

/// The length of something gives metres to a map that has none.
struct PlaneDistanceScale {
  double distance_m = 0.0;  ///< from the camera to the plane of the first object, at right angles
  std::optional<int>
      frame;  ///< default: the first object's placing frame, else the first with a pose
};
struct EdgeScale {
  double length_m = 0.0;  ///< between the points of planes under two pixels of a frame
  int frame = 0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};
struct HeightScale {
  double height_m = 0.0;  ///< of something that stands on a plane
  int frame = 0;
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();  ///< pixel of its foot, on the plane
  Eigen::Vector2d top = Eigen::Vector2d::Zero();   ///< pixel of its top, above the foot
};
struct MarkerScale {
  double size_m = 0.0;  ///< side of the black square
  MarkerId marker;
};
struct CameraHeightScale {
  double height_m = 0.0;     ///< of the camera over the floor: the median over the frames
  std::optional<int> frame;  ///< of this frame instead
};
struct ScaleHint {
  std::variant<PlaneDistanceScale, EdgeScale, HeightScale, MarkerScale, CameraHeightScale> rule;
  std::string where;
};

struct SceneFile {
  std::string name;                 ///< as given, for messages; empty: made without a file
  std::optional<FixedLight> light;  ///< nothing: estimated from the pictures
  bool shadows = true;
  Occlusion occlusion = Occlusion::kPlanes;
  Look look;
  int ease_frames = 8;     ///< causal: changes of the map reach the content over so many frames
  bool keep_apart = true;  ///< later objects give way to earlier ones that they would overlap
  std::vector<SceneObject> objects;
  std::optional<ScaleHint> scale;
};

/// Reads a scene file (docs/scene.md). Relative paths are looked up beside the file, then in the
/// current folder. Throws UserError "file:LINE: reason" for anything it does not know.
SceneFile read_scene_file(const std::filesystem::path& path);

/// Every marker that places or the scale are tied to, each once, ascending.
std::vector<MarkerId> markers_of(const SceneFile& scene);

}  // namespace planecast::engine
