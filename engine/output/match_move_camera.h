#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Frames per second of the pictures as the video plays them: by the median of their times'
/// differences. 30 when there are fewer than two frames.
double frame_rate(const std::vector<FrameRecord>& frames);

/// glTF's axes of a camera (x right, y up, looking along -z) in the field's (x right, y down, z
/// forward); its own inverse.
inline Eigen::Matrix3d flip_yz() { return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal(); }

/// Smallest turn of glTF's usual view of a camera world (flip_yz) that puts `up` on +y.
Eigen::Quaterniond gltf_from_world(const Eigen::Vector3d& up);

/// The final poses as keys of an animation. The picture of frame n shows at (n - first frame) /
/// frame rate, as in the video, however uneven the recording's own times are.
struct CameraTrack {
  std::vector<float> seconds;
  std::vector<std::array<float, 3>> translations;
  std::vector<std::array<float, 4>> rotations;  ///< x, y, z, w; glTF's axes, no sign jumps
};
CameraTrack camera_track(const std::vector<FrameRecord>& frames);

/// The same scene with y negated, in world and camera: a negative fy becomes positive.
Reconstruction mirrored(Reconstruction scene);

/// camera.chan, the camera as Nuke, Houdini and Blender's importer read it: one line a frame with a
/// pose, `frame tx ty tz rx ry rz fov`: the video's frame from 1 on; place and angles (degrees,
/// rotation order ZXY: about z first, then x, then y) in the y-up world of scene.glb; vertical
/// field of view in degrees. Throws UserError.
void write_chan(const Reconstruction& reconstruction, const std::filesystem::path& path);

}  // namespace planecast::engine
