#pragma once

#include "engine/sequence/synth/training_room.h"

/// Things without planes.
namespace planecast::engine::synth {

/// A rounded lump about `size` (x, y, z) standing at `place`: cushions, bags, stones, heaps.
void add_lump(TrainingBuilder& builder, const Place& place, const Eigen::Vector3d& size);
/// A sheet `size` (x, y) wide, crumpled to about `height`, lying at `place`.
void add_crumpled_cloth(TrainingBuilder& builder, const Place& place, const Eigen::Vector2d& size,
                        double height);
/// Bottles, vases, lamps, columns: a random profile turned about z.
void add_turned_thing(TrainingBuilder& builder, const Place& place, double radius, double height);
/// Folds hanging from a rail.
void add_folded_curtain(TrainingBuilder& builder, const Eigen::Vector3d& from,
                        const Eigen::Vector3d& to, double drop);
/// A tangle of cables within `reach` of the place.
void add_cables(TrainingBuilder& builder, const Place& place, double reach);
/// Capsules put together like someone standing, sitting or reaching.
void add_person(TrainingBuilder& builder, const Place& place);
/// A bush of bent leaves.
void add_bush(TrainingBuilder& builder, const Place& place, double size);

/// Any of the small ones, about `size` metres across, standing at `place`.
void add_small_clutter(TrainingBuilder& builder, const Place& place, double size);

}  // namespace planecast::engine::synth
