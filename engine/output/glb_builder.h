#pragma once

#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace planecast::engine {

/// Puts typed arrays into the one buffer of a glTF model; each function returns the accessor's
/// index.
class GlbBuilder {
 public:
  GlbBuilder();

  int add_positions(const std::vector<std::array<float, 3>>& positions);
  /// Linear RGBA as normalised 16-bit integers.
  int add_colors(const std::vector<std::array<std::uint16_t, 4>>& colors);
  int add_indices(const std::vector<std::uint32_t>& indices);
  /// Sampler input of an animation: seconds, strictly ascending.
  int add_times(const std::vector<float>& seconds);
  int add_vectors(const std::vector<std::array<float, 3>>& vectors);
  int add_quaternions(const std::vector<std::array<float, 4>>& quaternions);

  /// The .glb file's bytes; empty if tinygltf refuses.
  std::string bytes();

  tinygltf::Model model;

 private:
  template <typename T>
  int add(std::span<const T> values, int component_type, int type, int target);
  void set_bounds(int accessor, std::span<const float> values, std::size_t components);
};

}  // namespace planecast::engine
