#include "engine/pipeline/resume_tracking.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/output/atomic_file.h"
#include "engine/pipeline/reconstruction_io.h"
#include "engine/program.h"
#include "engine/sequence/camera_file.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

fs::path key_file(const fs::path& folder) { return folder / "resume.txt"; }

/// Threads are left out: they change nothing.
std::string key_of(const Sequence& sequence, const TrackSequenceOptions& options) {
  std::string key = fmt::format(
      "program {}\nsequence {}\nframes {}:{}\ncamera {}\nseed {}\nmode {}\nsegmentation {} {}\n"
      "planes {} {} {} {}\nfeatures {}\n",
      program_key(), fs::absolute(sequence.path()).lexically_normal().string(),
      sequence.first_frame(), sequence.end_frame(), camera_json(sequence.camera()).dump(),
      options.seed, options.mode, options.segmentation, options.network, options.plane_merge,
      options.plane_fit, options.map_planes, options.refine_jointly, options.features);
  if (options.up)
    key += fmt::format("up {} {} {}\n", options.up->x(), options.up->y(), options.up->z());
  if (options.causal) key += "causal\n";
  if (options.skip_unreadable) key += "skip unreadable\n";
  if (!options.close_loops) key += "no loops\n";
  if (!options.map.empty()) key += fmt::format("map {}\n", options.map);
  return key;
}

}  // namespace

void write_tracked(const Reconstruction& reconstruction, const Sequence& sequence,
                   const TrackSequenceOptions& options, const fs::path& folder) {
  if (reconstruction.frames.empty()) require_complete(reconstruction);
  std::error_code ignored;
  fs::remove(key_file(folder), ignored);
  write_reconstruction(reconstruction, folder);
  if (reconstruction.stopped.empty()) write_file(key_file(folder), key_of(sequence, options));
}

bool is_tracked(const Sequence& sequence, const TrackSequenceOptions& options,
                const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(key_file(folder), ignored) &&
         read_file(key_file(folder)) == key_of(sequence, options);
}

}  // namespace planecast::engine
