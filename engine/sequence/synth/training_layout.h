#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/sequence/synth/training_clutter.h"
#include "engine/sequence/synth/training_room.h"

namespace planecast::engine::synth {

/// One piece on the floor and what room it takes.
struct Spot {
  Place place;
  double radius;
};

/// Puts walls, floor, furniture and clutter into a room at random. `clutter`: 0 to 1.
class TrainingLayout {
 public:
  TrainingLayout(TrainingBuilder& builder, double clutter) : builder_(builder), clutter_(clutter) {}

  void build();

 private:
  double uniform(double a, double b) { return builder_.random().uniform(a, b); }
  bool chance(double share) { return builder_.chance(share); }

  void shell();
  void wall(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double height);
  void hang_on_wall(int patch, double width, double height);
  void piece();
  void table(const Place& place, const Eigen::Vector3d& size);
  void things_on(const Place& top, const Eigen::Vector3d& size, int count);
  void screen(const Place& place);
  void tilted_board(const Place& place, double width, double height);
  void shelf(const Place& place, const Eigen::Vector3d& size);
  void bed(const Place& place, const Eigen::Vector3d& size);
  void stairs(const Place& place, double width);
  void box(const Place& place, const Eigen::Vector3d& size, TileKind kind, bool underside = false);
  void loose_clutter();
  void loose_box();
  std::optional<Spot> find_spot(double radius, bool at_wall);

  TrainingBuilder& builder_;
  double clutter_;
  std::vector<Spot> taken_;
};

}  // namespace planecast::engine::synth
