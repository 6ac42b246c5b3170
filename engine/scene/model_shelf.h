#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/scene.h"

namespace planecast::engine {

/// Models by file, each read once.
class ModelShelf {
 public:
  /// Throws UserError naming the file.
  const std::shared_ptr<const render::Model>& load(const std::string& path);
  /// Of the models, each with its file.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::map<std::string, std::shared_ptr<const render::Model>> models_;
  std::vector<std::string> warnings_;
};

}  // namespace planecast::engine
