#include "engine/sequence/synth/training_room.h"

#include <algorithm>
#include <cmath>

#include "engine/sequence/synth/training_layout.h"

namespace planecast::engine::synth {
namespace {

bool touch(const Patch& a, const Patch& b) {
  constexpr float kGap_m = 0.02F;
  for (int axis = 0; axis < 3; ++axis) {
    float low_a = a.positions[0][axis], high_a = low_a;
    float low_b = b.positions[0][axis], high_b = low_b;
    for (std::size_t i = 1; i < 4; ++i) {
      low_a = std::min(low_a, a.positions[i][axis]);
      high_a = std::max(high_a, a.positions[i][axis]);
      low_b = std::min(low_b, b.positions[i][axis]);
      high_b = std::max(high_b, b.positions[i][axis]);
    }
    if (low_a > high_b + kGap_m || low_b > high_a + kGap_m) return false;
  }
  return true;
}

bool same_plane(const Patch& a, const Patch& b) {
  if (a.normals[0].dot(b.normals[0]) < 0.9999F) return false;
  return std::abs(a.normals[0].dot(b.positions[0] - a.positions[0])) < 0.003F;
}

/// One number for all flat patches that touch in one plane.
void number_planes(TrainingRoom& room) {
  const auto& patches = room.model.patches;
  room.plane.assign(patches.size(), 0);
  int next = 1;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches[i].cols != 1 || patches[i].rows != 1) continue;
    for (std::size_t j = 0; j < i && room.plane[i] == 0; ++j) {
      if (room.plane[j] != 0 && same_plane(patches[i], patches[j]) &&
          touch(patches[i], patches[j])) {
        room.plane[i] = room.plane[j];
      }
    }
    if (room.plane[i] == 0) room.plane[i] = next++;
  }
}

}  // namespace

TrainingPaint TrainingBuilder::random_paint(TileKind kind) {
  TrainingPaint paint;
  paint.kind = kind;
  paint.tile = random_.below(tiles_);
  paint.repeat_m = static_cast<float>(random_.uniform(0.6, 1.8));
  const double brightness = random_.uniform(0.5, 1.25);
  for (int c = 0; c < 3; ++c) {
    paint.tint[c] = static_cast<float>(brightness * random_.uniform(0.8, 1.1));
  }
  paint.shift = {static_cast<float>(random_.uniform()), static_cast<float>(random_.uniform())};
  return paint;
}

TrainingMaterial& TrainingBuilder::paint(TileKind kind) {
  TrainingMaterial material;
  material.paint = random_paint(kind);
  if (chance(0.4)) material.gloss = static_cast<float>(random_.uniform(0.05, 0.8));
  material.highlight = static_cast<float>(std::exp(random_.uniform(2.0, 5.5)));
  room_.materials.resize(room_.model.patches.size(), material);
  return room_.materials.back();
}

TrainingRoom make_training_room(std::uint64_t seed, const TileBank& bank) {
  TrainingRoom room;
  TrainingBuilder builder(room, bank, named_seed("training room", seed));
  const double clutter = builder.random().uniform();
  TrainingLayout(builder, clutter).build();
  builder.paint(TileKind::kObject);
  number_planes(room);
  return room;
}

}  // namespace planecast::engine::synth
