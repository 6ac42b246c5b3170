#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/sequence/synth/textures.h"

namespace planecast::engine::synth {

/// A piece of surface: a grid of (cols+1) x (rows+1) points, u along the columns, v along the rows.
/// A flat one is a parallelogram of one cell. It is seen from the side of its normals.
struct Patch {
  int cols = 1;
  int rows = 1;
  std::vector<Eigen::Vector3f> positions;  ///< metres, world (z up)
  std::vector<Eigen::Vector3f> normals;    ///< unit
  float width_m = 1.0F;                    ///< what u = 0..1 and v = 0..1 mean to the texture
  float height_m = 1.0F;
  Texture texture;
  float texels_per_m = 400.0F;
  float light_texel_m = 0.04F;  ///< grid on which the light is worked out
  int label = 0;                ///< instance label; 0: small or not flat
  bool shines = false;          ///< the texture is radiance: windows, lamp shades
  bool casts_shadow = true;

  /// Bilinear in the cell; u, v in [0, 1].
  Eigen::Vector3f position(float u, float v) const;
  Eigen::Vector3f normal(float u, float v) const;
};

/// A labelled plane as planes.json has it.
struct TruePlane {
  int label = 0;
  std::string plane_class;  ///< floor, ceiling, wall, horizontal, vertical, other
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;                   ///< normal . x + offset = 0
  std::vector<Eigen::Vector3d> polygon;  ///< counter-clockwise from the normal's side
  double area = 0.0;                     ///< m^2
};

/// A rectangle that gives light to the side of its normal; the sun comes in through it too.
struct WindowLight {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  Eigen::Vector3f u_axis = Eigen::Vector3f::UnitX();  ///< whole sides
  Eigen::Vector3f v_axis = Eigen::Vector3f::UnitZ();
  Color radiance = Color::Zero();
  int pane_columns = 2;  ///< bars between them keep the sun out
  int pane_rows = 2;
};

/// A small lamp.
struct LampLight {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  float radius_m = 0.08F;
  Color intensity = Color::Zero();  ///< radiance times area: irradiance is this / distance^2
};

struct SunLight {
  Eigen::Vector3f direction_to_sun = Eigen::Vector3f::UnitZ();
  Color radiance = Color::Zero();  ///< irradiance on a facing surface / pi; zero: no sun
};

/// A furnished place with its light. World: metres, z up, the floor at z = 0.
struct RoomModel {
  std::vector<Patch> patches;
  std::vector<TruePlane> planes;
  std::vector<WindowLight> windows;
  std::vector<LampLight> lamps;
  SunLight sun;
  Color ambient = Color::Constant(0.35F);  ///< radiance of the surroundings far from anything
  float exposure = 1.0F;
};

/// Faces from this size on are labelled and are planes of the truth.
inline constexpr double kMinPlaneArea = 0.05;

struct FlatOptions {
  std::string plane_class;  ///< empty: by the normal; "none": never labelled
  float texels_per_m = 400.0F;
  float light_texel_m = 0.04F;
};

/// Adds the rectangle origin + [0,1] u_axis + [0,1] v_axis, seen from the side of u x v; returns
/// its index in patches.
int add_flat(RoomModel& model, const Eigen::Vector3d& origin, const Eigen::Vector3d& u_axis,
             const Eigen::Vector3d& v_axis, Texture texture, const FlatOptions& options = {});

/// Textures of a box's faces as seen from its front (its local -y side).
struct BoxTextures {
  Texture front, right, back, left, top;
  static BoxTextures all(const Texture& texture) {
    return {texture, texture, texture, texture, texture};
  }
};

/// Where a piece stands: its own frame has z up and its front at -y.
struct Place {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the middle of its foot
  double yaw = 0.0;                                    ///< radians about z

  Eigen::Vector3d to_world(const Eigen::Vector3d& local) const;
  Eigen::Vector3d turn(const Eigen::Vector3d& local) const;
};

/// A box on its foot's middle; size (x, y, z). The underside is added only where it can be seen.
void add_box(RoomModel& model, const Place& place, const Eigen::Vector3d& size,
             const BoxTextures& textures, const FlatOptions& options = {}, bool underside = false);

/// A surface of revolution about the place's z: profile points (radius, height), outside to the
/// right of the way along it.
struct ProfilePoint {
  double radius;
  double height;
};
void add_revolution(RoomModel& model, const Place& place, const std::vector<ProfilePoint>& profile,
                    Texture texture, int segments = 22, bool shines = false);

void add_ball(RoomModel& model, const Eigen::Vector3d& centre, double radius, Texture texture);

/// A round bar along a polyline in the world.
void add_tube(RoomModel& model, const std::vector<Eigen::Vector3d>& path, double radius,
              Texture texture, int segments = 8);

/// A free sheet: points of (cols+1) x (rows+1), row by row; normals from the points, u x v.
void add_sheet(RoomModel& model, int cols, int rows, const std::vector<Eigen::Vector3d>& points,
               Texture texture, float width_m, float height_m, float texels_per_m = 400.0F);

}  // namespace planecast::engine::synth
