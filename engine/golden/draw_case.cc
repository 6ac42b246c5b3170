#include "engine/golden/draw_case.h"

#include <memory>

#include "engine/assets.h"
#include "engine/output/atomic_file.h"
#include "engine/pipeline/reconstruction_io.h"
#include "engine/pipeline/render_sequence.h"
#include "engine/scene/content.h"
#include "engine/scene/default_scene.h"
#include "engine/sequence/frame_options.h"
#include "engine/sequence/made_sequence.h"
#include "engine/user_error.h"
#include "render/renderer.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

/// The process's first renderer decides which instructions all of them use.
void use_portable_floats() {
  render::RendererOptions options;
  options.shader_dir = asset("shaders").string();
  options.portable_floats = true;
  const render::Renderer first(options);
}

/// The folder of a made sequence; complete where it has its final name.
fs::path made_sequence(const SynthOptions& options, const fs::path& cache,
                       const Progress& progress) {
  const fs::path folder = cache / made_sequence_name(options);
  std::error_code error;
  if (fs::exists(folder, error)) return folder;
  const fs::path unfinished = temporary_path(folder);
  fs::remove_all(unfinished, error);
  make_folder(unfinished);
  write_synthetic(options, unfinished, progress);
  commit_file(folder);
  return folder;
}

std::unique_ptr<Sequence> open_case(const GoldenCase& golden_case, const fs::path& cache,
                                    const Progress& progress) {
  SequenceOptions options;
  options.camera = golden_case.camera;
  if (!golden_case.range.empty()) parse_frames(golden_case.range, options);
  if (!golden_case.size.empty()) options.size = parse_size(golden_case.size);
  const fs::path path =
      golden_case.synth ? made_sequence(*golden_case.synth, cache, progress) : golden_case.sequence;
  std::unique_ptr<Sequence> sequence = open_sequence(path, options);
  for (const int frame : golden_case.frames) {
    if (frame >= sequence->first_frame() && frame < sequence->end_frame()) continue;
    throw UserError(path.string() + ": has no frame " + std::to_string(frame) + " in " +
                    std::to_string(sequence->first_frame()) + ":" +
                    std::to_string(sequence->end_frame()));
  }
  return sequence;
}

Reconstruction reconstruct(const GoldenCase& golden_case, Sequence& sequence, int threads,
                           const Progress& progress) {
  if (!golden_case.reconstruction.empty()) return read_reconstruction(golden_case.reconstruction);
  TrackSequenceOptions options;
  options.mode = golden_case.mode;
  options.segmentation = golden_case.segmentation;
  options.causal = golden_case.causal;
  options.seed = golden_case.seed;
  options.threads = threads;
  Reconstruction reconstruction = track_sequence(sequence, options, progress);
  require_complete(reconstruction);
  return reconstruction;
}

}  // namespace

GoldenPictures draw_golden_case(const GoldenCase& golden_case, const fs::path& cache, int threads,
                                const Progress& progress) {
  use_portable_floats();
  const std::unique_ptr<Sequence> sequence = open_case(golden_case, cache, progress);
  std::optional<SceneFile> scene;
  ModelShelf models;
  if (!golden_case.scene.empty()) {
    scene = read_scene_file(golden_case.scene);
    check_content(*scene, sequence->first_frame(), sequence->end_frame(), models);
  }
  const Reconstruction reconstruction = reconstruct(golden_case, *sequence, threads, progress);
  RenderSequenceOptions options;
  options.causal = golden_case.causal;
  options.seed = golden_case.seed;
  options.models = &models;
  const SceneFile chosen = scene ? *scene : default_scene(reconstruction, builtin_models());
  return draw_frames(*sequence, reconstruction, chosen, options, golden_case.frames).stills;
}

}  // namespace planecast::engine
