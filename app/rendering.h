#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/options.h"
#include "engine/pipeline/render_sequence.h"

namespace planecast::app {

/// Options of the second half, shared by `run` and `render`.
struct RenderingOptions {
  std::string scene;  ///< scene file; empty: one built-in model where the camera looks
  bool png = false;
  bool no_video = false;
  bool debug_overlay = false;
  bool resume = false;
  std::string painter = "auto";  ///< or "gl"
};
void add_rendering_options(CLI::App& command, RenderingOptions& options);

/// The scene file, checked as far as it can be before anything is tracked, which reads its models.
/// Nothing without one.
std::optional<engine::SceneFile> read_scene(const RenderingOptions& options,
                                            const engine::Sequence& sequence,
                                            engine::ModelShelf& models);

/// Renders with a progress bar; without a scene file places the built-in model.
engine::RenderSequenceResult render_with_progress(engine::Sequence& sequence,
                                                  const engine::Reconstruction& reconstruction,
                                                  const std::optional<engine::SceneFile>& scene,
                                                  const engine::RenderSequenceOptions& options,
                                                  const std::filesystem::path& folder,
                                                  const Console& console);

engine::RenderSequenceOptions resolve(const RenderingOptions& rendering,
                                      const CommonOptions& common, const InputOptions& input,
                                      bool causal, engine::ModelShelf& models);

/// Says on stderr how it went; the result's place and the figures are returned.
struct RenderingReport {
  std::string place;  ///< the video, or the folder where there is none
  nlohmann::ordered_json figures;
};
RenderingReport report_rendering(const engine::RenderSequenceResult& result,
                                 const std::filesystem::path& folder, const Console& console);

/// Cancelled, with what is there to go on from.
[[noreturn]] void throw_interrupted(const engine::RenderSequenceResult& result,
                                    const std::filesystem::path& folder);

}  // namespace planecast::app
