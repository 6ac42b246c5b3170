#include "render/gl/program.h"

#include <array>
#include <fstream>
#include <glm/gtc/type_ptr.hpp>
#include <sstream>
#include <stdexcept>

namespace planecast::render {
namespace {

constexpr int kMaxIncludeDepth = 8;

std::string first_line(const char* text) {
  const std::string_view view(text);
  return std::string(view.substr(0, view.find('\n')));
}

GLuint compile(const Gl& gl, GLenum stage, const std::string& file, const std::string& source) {
  const GLuint shader = gl.CreateShader(stage);
  const char* text = source.c_str();
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint ok = GL_FALSE;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok == GL_TRUE) return shader;
  std::array<char, 1024> log{};
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  gl.DeleteShader(shader);
  throw std::runtime_error("shader " + file + ": " + first_line(log.data()));
}

}  // namespace

void Program::set(std::string_view name, int value) const {
  gl_->ProgramUniform1i(handle_.id(), location(name), value);
}
void Program::set(std::string_view name, float value) const {
  gl_->ProgramUniform1f(handle_.id(), location(name), value);
}
void Program::set(std::string_view name, const glm::vec2& value) const {
  gl_->ProgramUniform2f(handle_.id(), location(name), value.x, value.y);
}
void Program::set(std::string_view name, const glm::vec3& value) const {
  gl_->ProgramUniform3fv(handle_.id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::vec4& value) const {
  gl_->ProgramUniform4fv(handle_.id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::mat3& value) const {
  gl_->ProgramUniformMatrix3fv(handle_.id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::mat4& value) const {
  gl_->ProgramUniformMatrix4fv(handle_.id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(std::string_view name, std::span<const glm::vec3> values) const {
  gl_->ProgramUniform3fv(handle_.id(), location(name), static_cast<GLsizei>(values.size()),
                         glm::value_ptr(values.front()));
}
void Program::set(std::string_view name, std::span<const glm::vec4> values) const {
  gl_->ProgramUniform4fv(handle_.id(), location(name), static_cast<GLsizei>(values.size()),
                         glm::value_ptr(values.front()));
}

GLint Program::location(std::string_view name) const {
  const auto found = locations_.find(name);
  if (found != locations_.end()) return found->second;
  std::string key(name);
  const GLint location = gl_->GetUniformLocation(handle_.id(), key.c_str());
  locations_.emplace(std::move(key), location);
  return location;
}

ShaderLibrary::ShaderLibrary(const Gl& gl, std::filesystem::path folder)
    : gl_(&gl), folder_(std::move(folder)) {
  if (!std::filesystem::is_directory(folder_)) {
    throw std::runtime_error("no shader folder " + folder_.string());
  }
}

const Program& ShaderLibrary::get(const std::string& vertex_file, const std::string& fragment_file,
                                  const std::vector<std::string>& defines) {
  std::string key = vertex_file + " " + fragment_file;
  for (const std::string& define : defines) key += " " + define;
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second;

  ProgramHandle handle(*gl_);
  const GLuint vertex = compile(*gl_, GL_VERTEX_SHADER, vertex_file, source(vertex_file, defines));
  gl_->AttachShader(handle.id(), vertex);
  gl_->DeleteShader(vertex);
  const GLuint fragment =
      compile(*gl_, GL_FRAGMENT_SHADER, fragment_file, source(fragment_file, defines));
  gl_->AttachShader(handle.id(), fragment);
  gl_->DeleteShader(fragment);
  gl_->LinkProgram(handle.id());
  GLint ok = GL_FALSE;
  gl_->GetProgramiv(handle.id(), GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::array<char, 1024> log{};
    gl_->GetProgramInfoLog(handle.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error("shaders " + key + ": " + first_line(log.data()));
  }
  return programs_.emplace(key, Program(*gl_, std::move(handle))).first->second;
}

std::string ShaderLibrary::source(const std::string& file,
                                  const std::vector<std::string>& defines) const {
  std::string text = "#version 450 core\n";
  for (const std::string& define : defines) text += "#define " + define + " 1\n";
  return text + read(file, 0);
}

std::string ShaderLibrary::read(const std::string& file, int depth) const {
  std::ifstream in(folder_ / file);
  if (!in || depth > kMaxIncludeDepth) {
    throw std::runtime_error("cannot read shader " + (folder_ / file).string());
  }
  constexpr std::string_view kInclude = "#include \"";
  std::ostringstream out;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kInclude)) {
      const std::size_t end = line.find('"', kInclude.size());
      out << read(line.substr(kInclude.size(), end - kInclude.size()), depth + 1);
    } else {
      out << line << '\n';
    }
  }
  return out.str();
}

}  // namespace planecast::render
