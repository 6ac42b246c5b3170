#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// A file that cannot be used; what() is one line. Never leaves render/gltf.
class ImportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads accessors, interleaved or sparse, after checking every offset, index and size in them
/// (glTF 2.0, section 3.6). Throws ImportError for what is inconsistent.
class AccessorReader {
 public:
  explicit AccessorReader(const tinygltf::Model& file) : file_(&file) {}

  std::size_t count(int accessor) const;
  int components(int accessor) const;
  /// `components` floats an element; integers are converted, normalised ones to [0, 1] or [-1, 1].
  std::vector<float> floats(int accessor, int components) const;
  /// Scalars or vectors of unsigned integers.
  std::vector<std::uint32_t> integers(int accessor, int components) const;

 private:
  const tinygltf::Model* file_;
};

}  // namespace planecast::render
