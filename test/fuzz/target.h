#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace planecast::fuzz {

/// One reader that must take any bytes: it answers with a value or its own error, and never
/// crashes, hangs or reads beyond. What it throws beside that error ends the process.
struct Target {
  const char* name;
  void (*run)(std::string_view bytes);
};

void read_gltf(std::string_view bytes);
void read_scene(std::string_view bytes);
void read_camera(std::string_view bytes);
void read_lists(std::string_view bytes);
void read_mask(std::string_view bytes);
void read_poses(std::string_view bytes);
void read_map(std::string_view bytes);
void read_planes(std::string_view bytes);
void read_tables(std::string_view bytes);
void read_command_line(std::string_view bytes);

inline constexpr Target kTargets[] = {
    {"gltf", read_gltf},     {"scene", read_scene},
    {"camera", read_camera}, {"lists", read_lists},
    {"mask", read_mask},     {"poses", read_poses},
    {"map", read_map},       {"planes", read_planes},
    {"tables", read_tables}, {"command_line", read_command_line},
};

}  // namespace planecast::fuzz
