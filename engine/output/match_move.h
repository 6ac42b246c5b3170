#pragma once

#include <filesystem>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/object_record.h"

namespace planecast::engine {

/// scene.glb, the match-move scene: node "world" turns the reconstruction's world to glTF's (y up);
/// under it node "camera" with the final poses as an animation (translation and rotation, linear,
/// key times as the video plays: see camera_track; frames without a pose are bridged), one node a
/// plane ("plane <id> <class>") with its polygon triangulated in the plane's colour, "points" with
/// the colours seen in the images, and one node an object ("object <name>") whose own space is its
/// model's, with a box of the model's bounds and the model's file in the extras. The glTF camera
/// looks along -z with y up, yfov = 2 atan(height / 2 |fy|); the principal point, which glTF cannot
/// express, is in the camera's extras, frame rate and number of frames are in the world's. Lens
/// distortion is not included: the camera is the ideal pinhole. Of a camera with negative fy (the
/// world is then left-handed) the mirrored, right-handed world is written. Throws UserError.
void write_match_move(const Reconstruction& reconstruction, const std::filesystem::path& path,
                      const std::vector<ObjectRecord>& objects = {});

}  // namespace planecast::engine
