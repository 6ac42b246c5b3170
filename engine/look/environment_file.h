#pragma once

#include <filesystem>
#include <memory>

#include "render/environment.h"
#include "render/scene.h"

namespace planecast::engine {

/// Recorded surroundings as light.
struct EnvironmentLight {
  std::shared_ptr<const render::Environment> environment;
  render::Sun sun;        ///< what was one small bright place of the map; black when there is none
  float exposure = 1.0F;  ///< makes a white level surface as bright as white
};

/// Reads an equirectangular picture of linear radiance (Radiance .hdr), +y up. A sun is taken out
/// of the map, so that it throws shadows. Throws UserError when the file is no such picture.
EnvironmentLight load_environment(const std::filesystem::path& file);

/// The same from memory: RGB.
EnvironmentLight environment_light(render::ImageF map);

}  // namespace planecast::engine
