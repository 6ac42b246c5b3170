#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/objects.h"

namespace planecast::render {

/// A linked program. Uniforms are set by name; one the compiler has dropped is ignored.
class Program {
 public:
  Program(const Gl& gl, ProgramHandle handle) : gl_(&gl), handle_(std::move(handle)) {}

  void use() const { gl_->UseProgram(handle_.id()); }
  void set(std::string_view name, int value) const;
  void set(std::string_view name, float value) const;
  void set(std::string_view name, const glm::vec2& value) const;
  void set(std::string_view name, const glm::vec3& value) const;
  void set(std::string_view name, const glm::vec4& value) const;
  void set(std::string_view name, const glm::mat3& value) const;
  void set(std::string_view name, const glm::mat4& value) const;
  void set(std::string_view name, std::span<const glm::vec3> values) const;
  void set(std::string_view name, std::span<const glm::vec4> values) const;

 private:
  GLint location(std::string_view name) const;

  const Gl* gl_;
  ProgramHandle handle_;
  mutable std::map<std::string, GLint, std::less<>> locations_;
};

/// Compiles the shader files of a folder on demand and keeps the programs. `#include "file"` on a
/// line of its own is replaced by that file of the same folder.
class ShaderLibrary {
 public:
  ShaderLibrary(const Gl& gl, std::filesystem::path folder);

  /// `defines` become `#define NAME 1`: variants instead of branches, because a software rasteriser
  /// executes both sides of a branch. Throws std::runtime_error with the compiler's first line.
  const Program& get(const std::string& vertex_file, const std::string& fragment_file,
                     const std::vector<std::string>& defines = {});

 private:
  std::string source(const std::string& file, const std::vector<std::string>& defines) const;
  std::string read(const std::string& file, int depth) const;

  const Gl* gl_;
  std::filesystem::path folder_;
  std::map<std::string, Program> programs_;
};

}  // namespace planecast::render
