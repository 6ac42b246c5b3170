#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "slam/data/types.h"

namespace planecast::render {
class Model;
}

namespace planecast::engine {

/// A model where it was placed.
struct ObjectRecord {
  std::string name;
  std::string file;  ///< the model's
  int plane = slam::kNone;
  Eigen::Affine3d world_from_model = Eigen::Affine3d::Identity();
  Eigen::AlignedBox3d box;  ///< the model's bounds in its own space
  std::shared_ptr<const render::Model> model;
};

}  // namespace planecast::engine
