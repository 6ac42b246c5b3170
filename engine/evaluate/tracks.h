#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/evaluate/statistics.h"
#include "engine/pipeline/reconstruction.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

struct TrackOptions {
  std::optional<int> frame;  ///< where the points are anchored; default: see evaluate_tracks
  std::string plane;         ///< id or rule; empty: the plane that faces up with most texture there
  int points = 30;
  int least_distance_px = 14;      ///< between two of them
  double thickness_share = 0.003;  ///< of the distance: landmarks nearer to the plane lie on it
  double least_corner = 0.02;      ///< cornerness, of the strongest candidate's
  double min_correlation = 0.8;    ///< of a patch found again
  double max_return_px = 0.5;      ///< from the anchor, of the patch sent back; see evaluate_tracks
  double max_shift_px = 12.0;      ///< from its projection, in which a patch is looked for
  double border_px = 12.0;         ///< points nearer to the picture's edge do not count as visible
  double max_slant_deg = 78.0;     ///< nor planes seen flatter
  double max_zoom = 2.5;           ///< nor patches that much larger or smaller than at the anchor
  double depth_tolerance = 0.04;   ///< with depth images: nor points this share before or behind
  double hidden_px = 8.0;          ///< without: nor points so near to where a map point is seen
  double hidden_share = 0.02;      ///< that is off the plane by this share of the distance
};

/// How content anchored at one frame keeps to the picture's own texture in the others, without any
/// truth.
struct TracksResult {
  int frame = 0;  ///< the anchors'
  int plane_id = slam::kNone;
  int points = 0;
  int frames = 0;    ///< others with a pose that see any of them
  int visible = 0;   ///< points times frames
  int compared = 0;  ///< of them, found again
  Statistics error_px;
  double compared_share() const { return visible > 0 ? 1.0 * compared / visible : 0.0; }
};

/// Anchors textured points of a plane by hit test at one frame (by default, of the first ten in
/// equal steps the one with most candidates) and compares where each is projected in every other
/// frame with where its texture is found there: its patch, warped by the plane, is aligned to
/// sub-pixels near the projection and back from there to the first frame, where it must end near
/// the anchor, in pixels of the picture that shows it smaller. A point that something of the map
/// stands before does not count as visible. Pixels are raw ones. Candidates lie where the map has
/// points of that plane, so that they are on it and not before it. Throws UserError for frames and
/// planes that are not there and when no point is found.
TracksResult evaluate_tracks(const Reconstruction& reconstruction, Sequence& sequence,
                             const TrackOptions& options = {});

std::string format_table(const TracksResult& result);
nlohmann::ordered_json to_json(const TracksResult& result);

}  // namespace planecast::engine
