#pragma once

namespace tinygltf {
class Model;
struct Material;
struct Primitive;
}  // namespace tinygltf
