#pragma once

#include <cstdint>
#include <vector>

#include "engine/sequence/synth/random.h"
#include "engine/sequence/synth/room_model.h"
#include "engine/sequence/synth/training_textures.h"

namespace planecast::engine::synth {

/// A tile laid over a surface.
struct TrainingPaint {
  TileKind kind = TileKind::kObject;
  int tile = 0;
  float repeat_m = 1.0F;           ///< what one repeat of the tile covers
  Color tint = Color::Ones();      ///< times the tile
  float glow = 0.0F;               ///< radiance of its own, times the tile: screens, windows, lamps
  Eigen::Vector2f shift = {0, 0};  ///< of the tile, in repeats
};

/// Something flat on a surface that shares its plane.
struct TrainingDecal {
  float u_m, v_m, width_m, height_m;  ///< lower left corner and size on the patch
  TrainingPaint paint;
  float rim_m = 0.0F;  ///< of the paint's half brightness: frames, joints
};

struct TrainingMaterial {
  TrainingPaint paint;
  float gloss = 0.0F;       ///< of highlights, 0: matt
  float highlight = 40.0F;  ///< their sharpness (exponent)
  std::vector<TrainingDecal> decals;
};

/// A room made to be varied rather than true to any: what the network learns from.
struct TrainingRoom {
  RoomModel model;
  Eigen::Vector3d size = {4, 4, 2.5};
  std::vector<TrainingMaterial> materials;  ///< by patch
  std::vector<int> plane;                   ///< by patch: 1.. one number a plane, 0: not flat
  std::vector<Eigen::Vector3d> sights;      ///< what a camera may look at
};

/// Layout, furniture, clutter, materials and lights are functions of the seed.
TrainingRoom make_training_room(std::uint64_t seed, const TileBank& bank);

/// Puts patches into a room and paints those that came since.
class TrainingBuilder {
 public:
  TrainingBuilder(TrainingRoom& room, const TileBank& bank, std::uint64_t seed)
      : room_(room), random_(seed), tiles_(bank.per_kind()) {}

  TrainingRoom& room() { return room_; }
  RoomModel& model() { return room_.model; }
  Random& random() { return random_; }
  bool chance(double share) { return random_.uniform() < share; }
  TrainingPaint random_paint(TileKind kind);
  /// One new material for all patches that have none yet.
  TrainingMaterial& paint(TileKind kind);
  /// Only a patch index is given back: references go stale.
  TrainingMaterial& material(int patch) { return room_.materials[static_cast<std::size_t>(patch)]; }
  int patches() const { return static_cast<int>(room_.model.patches.size()); }

 private:
  TrainingRoom& room_;
  Random random_;
  int tiles_;
};

}  // namespace planecast::engine::synth
