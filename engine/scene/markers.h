#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/scene_file.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// A marker where it lies in the map.
struct FoundMarker {
  int plane_id = slam::kNone;              ///< the plane it lies on; kNone: on no plane of the map
  std::array<Eigen::Vector3d, 4> corners;  ///< world; clockwise from the print's top left
  int views = 0;

  Eigen::Vector3d centre() const;
  Eigen::Vector3d x_axis() const;  ///< unit, to the print's right
  Eigen::Vector3d normal() const;  ///< unit, towards the reader
  double side() const;             ///< mean length of the four sides
};

using MarkerMap = std::map<MarkerId, FoundMarker>;

struct MarkerOptions {
  int most_frames = 60;  ///< looked at, evenly taken from the frames with a pose
  double near_plane_share =
      0.05;  ///< of the viewing distance: a marker so near to a plane lies on it
  double near_plane_deg = 25.0;
  double least_parallax_deg = 1.5;  ///< between the rays to it, for a place without a plane
};

/// Looks for markers in the pictures and places them: on the plane of the map that most views show
/// them on, as the mean of where the rays of their corners meet it; where no plane is, by the rays
/// themselves. Markers that are not seen, or only from one place and on no plane, are left out.
/// Frames that cannot be read are passed over.
MarkerMap find_markers(Sequence& sequence, const Reconstruction& reconstruction,
                       const std::vector<MarkerId>& wanted, const MarkerOptions& options = {});

}  // namespace planecast::engine
