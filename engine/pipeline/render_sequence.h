#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/pipeline/track_sequence.h"
#include "engine/scene/model_shelf.h"
#include "engine/scene/object_record.h"
#include "engine/scene/scene_file.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

struct RenderSequenceOptions {
  bool causal = false;           ///< poses as they were known at their frame
  bool video = true;             ///< augmented.mp4
  bool png = false;              ///< frames/NNNNNN.png
  bool debug_overlay = false;    ///< plane outlines and the frame's state drawn over the picture
  bool resume = false;           ///< go on after the last complete video segment of a killed run
  bool skip_unreadable = false;  ///< repeat the last picture instead of ending
  bool only_opengl = false;      ///< layers are never drawn by the processor directly
  int threads = 2;               ///< changes no result
  std::uint64_t seed = 1;
  int stills = 4;                ///< pictures kept for the report
  ModelShelf* models = nullptr;  ///< where models that were read before are found
};

struct RenderSequenceResult {
  int frames = 0;            ///< written by this call
  bool interrupted = false;  ///< asked to end: the video is not joined, its complete segments stay
  int with_content = 0;      ///< of them, those in which something was drawn
  int by_processor = 0;      ///< of those, the ones drawn without OpenGL
  double units_per_metre = 0.0;  ///< as the sizes counted; 0: the map has no scale
  std::vector<int> unreadable;
  std::filesystem::path video;                  ///< empty when there is none
  std::vector<std::pair<int, cv::Mat>> stills;  ///< frame number and BGR picture
  std::vector<std::string> warnings;
  std::map<std::string, double> mean_ms;  ///< per frame, by step
  std::map<int, StageTimes> frame_times;  ///< by frame number, of frames with a pose
  std::vector<ObjectRecord> objects;
  std::string renderer;  ///< the driver's own description
};

/// Draws the scene over every frame of the sequence. Frames without a pose keep their picture.
/// Reading, drawing and encoding overlap, in order. Throws UserError for scene and input errors;
/// when a frame in the middle cannot be read, after everything before it was completed. A request
/// to cancel (engine/cancel.h) ends it after the frame it is at.
RenderSequenceResult render_sequence(Sequence& sequence, const Reconstruction& reconstruction,
                                     const SceneFile& scene, const RenderSequenceOptions& options,
                                     const std::filesystem::path& folder, const Progress& progress);

/// Draws the scene over single frames of the sequence, given by their numbers, into `stills`;
/// nothing is written. Each picture is the same as in the video before it is encoded.
RenderSequenceResult draw_frames(Sequence& sequence, const Reconstruction& reconstruction,
                                 const SceneFile& scene, const RenderSequenceOptions& options,
                                 const std::vector<int>& frames);

}  // namespace planecast::engine
