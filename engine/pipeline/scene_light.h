#pragma once

#include "engine/look/light.h"
#include "engine/pipeline/reconstruction.h"
#include "engine/scene/scene_file.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// The scene file's sun and sky in the world: y up, x to the right of the world's (first
/// keyframe's) camera, z towards its viewer.
SceneLight fixed_light(const FixedLight& light, const Eigen::Vector3d& up);

/// Estimates the light from `samples` frames with poses, evenly taken from the sequence. Frames
/// that cannot be read are passed over.
SceneLight estimate_light(Sequence& sequence, const Reconstruction& reconstruction,
                          int samples = 10);

}  // namespace planecast::engine
