#pragma once

#include <map>
#include <memory>
#include <string>

#include "render/scene.h"

namespace planecast::render {

enum class ContextKind { kOsMesa, kEgl };

struct RendererOptions {
  ContextKind context = ContextKind::kOsMesa;
  std::string shader_dir;      ///< assets/shaders
  int msaa_samples = 4;        ///< 4 or 1
  int shadow_map_size = 1024;  ///< rounded down to a power of two
  /// Meshes are drawn with fewer triangles where the difference stays below this many pixels on the
  /// screen, or texels of a shadow; 0 draws them as they are.
  float simplify_px = 0.5F;
  /// Keeps Mesa from using instructions (fused multiply-add) that round differently on processors
  /// that lack them: the same bytes on any x86-64, at 1.25 to 1.6 times the time. Holds for the
  /// whole process from its first context on; for golden tests.
  bool portable_floats = false;
  /// Layers are always drawn through OpenGL, never by the processor directly: slower, for
  /// comparison.
  bool only_opengl = false;
  bool time_passes = false;  ///< for pass_times_ms(); slows down
};

/// Draws offscreen; the same bytes for the same input. Not thread-safe: one renderer, one thread.
/// Construction throws std::runtime_error with one line when no context can be made.
class Renderer {
 public:
  explicit Renderer(const RendererOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Virtual objects, their shadows on the catchers, hidden by the occluders.
  Layer draw_layer(const LayerScene& scene, const Camera& camera);
  /// A whole opaque picture with depth and labels. Surfaces are uploaded once a scene object: call
  /// again with the same `scene` address and unchanged surfaces to reuse them, or forget() first.
  OpaqueImages draw_opaque(const OpaqueScene& scene, const Camera& camera);
  void forget();
  /// Milliseconds by pass since the last call, when they are timed.
  std::map<std::string, double> pass_times_ms();
  /// "4.5 (Core Profile) Mesa ..." for the record.
  std::string description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planecast::render
