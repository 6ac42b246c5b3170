#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/image.h"
#include "render/passes/catcher_plan.h"
#include "render/passes/models.h"
#include "render/software/coverage.h"
#include "render/software/posed_meshes.h"

namespace planecast::render {

/// Share of the surroundings' light that objects take from each point of a plane, over the plan's
/// contact region: as heights.frag, contact.frag and contact_blur.frag, drawn by the processor.
class ContactMap {
 public:
  /// Meshes may be off by `detail_texels`.
  void make(const CatcherPlan& plan, const std::vector<DrawItem>& items, const PosedMeshes& meshes,
            float detail_texels);
  /// Square, one channel.
  const ImageF& hidden() const { return hidden_; }

 private:
  void draw_heights(const CatcherPlan& plan, const std::vector<DrawItem>& items,
                    const PosedMeshes& meshes, float error_m);
  void draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c);
  void split_heights();
  void find_hidden(const CatcherPlan& plan);
  void blur(const ImageF& sharp);
  std::size_t split_place(int x, int y) const;

  int side_ = 0;
  int margin_ = 0;  ///< around the split heights, in whole groups of four texels
  std::vector<F4> tops_;
  std::vector<F4> undersides_;
  std::vector<ScreenVertex> screen_;
  /// Squared heights; every fourth texel of a row one after another, so that texels that look into
  /// the same directions are neighbours.
  std::vector<float> split_tops_;
  std::vector<float> split_undersides_;
  ImageF hidden_;
};

}  // namespace planecast::render
