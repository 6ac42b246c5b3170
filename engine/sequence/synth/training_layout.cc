#include "engine/sequence/synth/training_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "engine/sequence/synth/furniture.h"

namespace planecast::engine::synth {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

Texture unpainted() { return plain(Color::Ones()); }

BoxTextures unpainted_box() { return BoxTextures::all(unpainted()); }

}  // namespace

void TrainingLayout::build() {
  shell();
  const Vector3d& size = builder_.room().size;
  const int pieces = 3 + builder_.random().below(static_cast<int>(size.x() * size.y() * 0.4) + 3);
  for (int i = 0; i < pieces; ++i) piece();
  const int loose = static_cast<int>(clutter_ * size.x() * size.y() * uniform(0.3, 1.2));
  for (int i = 0; i < loose; ++i) loose_clutter();
  const int boxes = builder_.random().below(7);
  for (int i = 0; i < boxes; ++i) loose_box();
}

void TrainingLayout::wall(const Vector3d& from, const Vector3d& along, double height) {
  const int patch = add_flat(builder_.model(), from, along, {0, 0, height}, unpainted());
  builder_.paint(TileKind::kWall);
  const double length = along.norm();
  hang_on_wall(patch, length, height);
  const Vector3d inwards = along.cross(Vector3d::UnitZ()).normalized();
  if (chance(0.12 + 0.25 * clutter_)) {
    const double a = uniform(0.0, 0.6);
    const double b = std::min(a + uniform(0.2, 0.6), 1.0);
    const Vector3d rail = from + Vector3d(0, 0, height - 0.05) + 0.04 * inwards;
    add_folded_curtain(builder_, rail + a * along, rail + b * along, height * uniform(0.5, 0.97));
  }
}

void TrainingLayout::hang_on_wall(int patch, double width, double height) {
  std::vector<TrainingDecal> decals;
  const int count = builder_.random().below(4);
  for (int i = 0; i < count; ++i) {
    TrainingDecal decal{};
    decal.width_m = static_cast<float>(uniform(0.2, std::min(1.6, 0.8 * width)));
    decal.height_m = static_cast<float>(uniform(0.2, 1.2));
    decal.u_m = static_cast<float>(uniform(0.0, width)) - 0.5F * decal.width_m;
    decal.v_m = static_cast<float>(uniform(0.5, height - 0.3));
    decal.paint = builder_.random_paint(TileKind::kPrint);
    decal.paint.repeat_m = std::max(decal.width_m, decal.height_m);
    decal.rim_m = chance(0.5) ? 0.025F : 0.0F;
    if (chance(0.3)) {  // a window
      decal.paint.glow = static_cast<float>(uniform(0.6, 3.0));
      decal.rim_m = 0.05F;
    } else if (chance(0.25)) {  // a door
      decal.v_m = 0.0F;
      decal.height_m = 2.0F;
      decal.width_m = 0.85F;
      decal.paint = builder_.random_paint(TileKind::kWood);
      decal.rim_m = 0.06F;
    }
    decals.push_back(decal);
  }
  if (chance(0.6)) {  // a skirting board
    TrainingDecal board{0.0F, 0.0F, static_cast<float>(width),
                        static_cast<float>(uniform(0.05, 0.12)),
                        builder_.random_paint(TileKind::kWood)};
    decals.push_back(board);
  }
  builder_.material(patch).decals = decals;
}

void TrainingLayout::shell() {
  TrainingRoom& room = builder_.room();
  room.size = {uniform(2.2, 7.5), uniform(2.2, 7.5), uniform(2.2, 3.4)};
  const Vector3d& s = room.size;
  RoomModel& model = builder_.model();
  const int floor = add_flat(model, {0, 0, 0}, {s.x(), 0, 0}, {0, s.y(), 0}, unpainted());
  builder_.paint(TileKind::kFloor);
  if (chance(0.4)) {
    TrainingDecal rug{static_cast<float>(uniform(0.0, 0.5 * s.x())),
                      static_cast<float>(uniform(0.0, 0.5 * s.y())),
                      static_cast<float>(uniform(0.8, 2.5)), static_cast<float>(uniform(0.6, 2.0)),
                      builder_.random_paint(TileKind::kCloth)};
    builder_.material(floor).decals.push_back(rug);
  }
  // The corner at the far end of the first two walls may be cut off by a slanted one.
  const double cut = chance(0.2) ? uniform(0.4, 0.45 * std::min(s.x(), s.y())) : 0.0;
  wall({s.x(), 0, 0}, {-s.x(), 0, 0}, s.z());
  wall({0, 0, 0}, {0, s.y(), 0}, s.z());
  wall({0, s.y(), 0}, {s.x() - cut, 0, 0}, s.z());
  if (cut > 0.0) wall({s.x() - cut, s.y(), 0}, {cut, -cut, 0}, s.z());
  wall({s.x(), s.y() - cut, 0}, {0, cut - s.y(), 0}, s.z());
  if (chance(0.15)) {  // under a roof
    const double low = uniform(0.9, 1.8);
    const double reach = uniform(0.8, 0.6 * s.y());
    add_flat(model, {0, 0, low}, {0, reach, s.z() - low}, {s.x(), 0, 0}, unpainted());
    builder_.paint(TileKind::kWall);
  }
  add_flat(model, {0, s.y(), s.z()}, {s.x(), 0, 0}, {0, -s.y(), 0}, unpainted());
  builder_.paint(TileKind::kWall);
  builder_.material(builder_.patches() - 1).paint.tint *= 1.2F;
  if (chance(0.25)) {  // a pillar or a piece of wall that stands out
    box({{uniform(0.2, s.x() - 0.2), uniform(0.2, s.y() - 0.2), 0}, 0.0},
        {uniform(0.2, 0.8), uniform(0.2, 0.8), s.z()}, TileKind::kWall);
  }
  if (chance(0.2 * clutter_ + 0.05)) {
    const Place place{{uniform(0.5, s.x() - 0.5), uniform(0.5, s.y() - 0.5), 0}, 0.0};
    add_turned_thing(builder_, place, uniform(0.1, 0.35), s.z());
    taken_.push_back({place, 0.4});
  }
}

std::optional<Spot> TrainingLayout::find_spot(double radius, bool at_wall) {
  const Vector3d& s = builder_.room().size;
  for (int attempt = 0; attempt < 12; ++attempt) {
    Spot spot{{}, radius};
    const double margin = std::min({radius, 0.45 * s.x(), 0.45 * s.y()});
    spot.place.position = {uniform(margin, s.x() - margin), uniform(margin, s.y() - margin), 0.0};
    spot.place.yaw = chance(0.3) ? uniform(-kPi, kPi) : 0.5 * kPi * builder_.random().below(4);
    if (at_wall) {
      const int side = builder_.random().below(4);
      const double gap = 0.6 * margin;
      if (side == 0) spot.place = {{spot.place.position.x(), s.y() - gap, 0}, 0.0};
      if (side == 1) spot.place = {{spot.place.position.x(), gap, 0}, kPi};
      if (side == 2) spot.place = {{gap, spot.place.position.y(), 0}, 0.5 * kPi};
      if (side == 3) spot.place = {{s.x() - gap, spot.place.position.y(), 0}, -0.5 * kPi};
    }
    const bool free = std::none_of(taken_.begin(), taken_.end(), [&spot](const Spot& other) {
      return (other.place.position - spot.place.position).norm() <
             0.8 * (other.radius + spot.radius);
    });
    if (free) return spot;
  }
  return std::nullopt;
}

void TrainingLayout::box(const Place& place, const Vector3d& size, TileKind kind, bool underside) {
  add_box(builder_.model(), place, size, unpainted_box(), {}, underside);
  const int first = builder_.patches() - (underside ? 6 : 5);
  builder_.paint(kind);
  const double style = uniform(0.0, 1.0);
  if (style < 0.35) {  // a print on the front and maybe the top
    for (const int face : {first, first + 4}) {
      if (chance(0.4)) continue;
      const auto width = static_cast<float>(size.x());
      const auto height = static_cast<float>(face == first ? size.z() : size.y());
      TrainingDecal print{0.1F * width, 0.1F * height, 0.8F * width, 0.8F * height,
                          builder_.random_paint(TileKind::kPrint)};
      print.paint.repeat_m = std::max(width, height);
      builder_.material(face).decals.push_back(print);
    }
  } else if (style < 0.6) {  // doors or drawers
    const int columns = 1 + builder_.random().below(3);
    const int rows = 1 + builder_.random().below(4);
    const TrainingPaint panel = builder_.random_paint(kind);
    const auto w = static_cast<float>(size.x() / columns);
    const auto h = static_cast<float>(size.z() / rows);
    for (int i = 0; i < columns * rows; ++i) {
      TrainingDecal door{w * static_cast<float>(i % columns) + 0.02F * w,
                         h * static_cast<float>(i / columns) + 0.02F * h,
                         0.96F * w,
                         0.96F * h,
                         panel,
                         chance(0.5) ? 0.02F : 0.005F};
      builder_.material(first).decals.push_back(door);
      TrainingDecal handle{door.u_m + 0.4F * w, door.v_m + 0.8F * h, 0.2F * w, 0.02F,
                           builder_.random_paint(TileKind::kObject)};
      builder_.material(first).decals.push_back(handle);
    }
  } else if (style < 0.75) {  // faces of different colour
    for (int face = first; face < builder_.patches(); ++face) {
      builder_.material(face).paint = builder_.random_paint(kind);
    }
  }
}

void TrainingLayout::things_on(const Place& top, const Vector3d& size, int count) {
  for (int i = 0; i < count; ++i) {
    const Place place{
        top.to_world({uniform(-0.45, 0.45) * size.x(), uniform(-0.45, 0.45) * size.y(), 0}),
        uniform(-kPi, kPi)};
    const double each = uniform(0.06, 0.3);
    if (chance(0.35 + 0.4 * clutter_)) {
      add_small_clutter(builder_, place, each);
    } else {
      const Vector3d book(uniform(0.08, 0.35), uniform(0.08, 0.3), uniform(0.01, 0.25));
      box(place, book, TileKind::kObject);
    }
  }
  builder_.room().sights.push_back(top.position);
}

void TrainingLayout::screen(const Place& place) {
  const double width = uniform(0.3, 0.7);
  const double height = width * uniform(0.55, 0.7);
  const Place up{place.to_world({0, 0, 0.08}), place.yaw};
  box(up, {width, 0.03, height}, TileKind::kObject, true);
  const int front = builder_.patches() - 6;
  TrainingDecal picture{0.02F, 0.02F, static_cast<float>(width - 0.04),
                        static_cast<float>(height - 0.04), builder_.random_paint(TileKind::kPrint)};
  picture.paint.repeat_m = static_cast<float>(width);
  picture.paint.glow = chance(0.7) ? static_cast<float>(uniform(0.2, 1.2)) : 0.0F;
  if (chance(0.3)) picture.paint.tint *= 0.05F;  // switched off
  builder_.material(front).decals = {picture};
  add_turned_thing(builder_, place, 0.1, 0.12);
}

void TrainingLayout::tilted_board(const Place& place, double width, double height) {
  const double tilt = uniform(0.2, 1.2);
  const Vector3d across = place.turn({width, 0, 0});
  const Vector3d up = place.turn({0, height * std::cos(tilt), height * std::sin(tilt)});
  const Vector3d corner = place.position - 0.5 * across + Vector3d(0, 0, 0.01);
  add_flat(builder_.model(), corner, across, up, unpainted());
  builder_.paint(chance(0.5) ? TileKind::kWood : TileKind::kPrint);
  add_flat(builder_.model(), corner - place.turn({0, -0.012, 0}), up, across, unpainted());
  builder_.paint(TileKind::kWood);
}

void TrainingLayout::table(const Place& place, const Vector3d& size) {
  constexpr double kBoard = 0.03;
  box({place.to_world({0, 0, size.z() - kBoard}), place.yaw}, {size.x(), size.y(), kBoard},
      TileKind::kWood, true);
  if (chance(0.3)) {
    const Vector3d drawers(0.4, 0.85 * size.y(), size.z() - kBoard);
    box({place.to_world({0.5 * size.x() - 0.22, 0, 0}), place.yaw}, drawers, TileKind::kWood);
  } else {
    const double leg = uniform(0.03, 0.09);
    for (const double sx : {-0.46, 0.46}) {
      for (const double sy : {-0.44, 0.44}) {
        const Place foot{place.to_world({sx * size.x(), sy * size.y(), 0}), place.yaw};
        if (chance(0.5)) {
          add_box(builder_.model(), foot, {leg, leg, size.z() - kBoard}, unpainted_box());
        } else {
          add_revolution(builder_.model(), foot, {{0.5 * leg, 0.0}, {0.5 * leg, size.z() - kBoard}},
                         unpainted(), 8);
        }
      }
    }
    builder_.paint(TileKind::kWood);
  }
  const Place top{place.to_world({0, 0, size.z()}), place.yaw};
  things_on(top, size, 1 + builder_.random().below(4 + static_cast<int>(9 * clutter_)));
  if (chance(0.4))
    screen({top.to_world({uniform(-0.3, 0.3) * size.x(), 0.25 * size.y(), 0}), place.yaw});
  if (chance(0.25)) {
    tilted_board({top.to_world({uniform(-0.3, 0.3) * size.x(), 0, 0}), place.yaw},
                 uniform(0.2, 0.4), uniform(0.15, 0.35));
  }
}

void TrainingLayout::shelf(const Place& place, const Vector3d& size) {
  const int boards = 2 + builder_.random().below(4);
  for (int i = 0; i <= boards; ++i) {
    add_box(builder_.model(), {place.to_world({0, 0, i * (size.z() - 0.02) / boards}), place.yaw},
            {size.x(), size.y(), 0.02}, unpainted_box(), {}, true);
  }
  for (const double s : {-0.5, 0.5}) {
    add_box(builder_.model(), {place.to_world({s * size.x(), 0, 0}), place.yaw},
            {0.02, size.y(), size.z()}, unpainted_box(), {}, true);
  }
  builder_.paint(TileKind::kWood);
  for (int i = 0; i < boards; ++i) {
    const Place board{place.to_world({0, 0, 0.02 + i * (size.z() - 0.02) / boards}), place.yaw};
    things_on(board, {0.9 * size.x(), 0.6 * size.y(), 0}, builder_.random().below(6));
  }
}

void TrainingLayout::bed(const Place& place, const Vector3d& size) {
  box(place, size, TileKind::kWood);
  const Place top{place.to_world({0, 0, size.z()}), place.yaw};
  add_crumpled_cloth(builder_, top, {1.05 * size.x(), 1.05 * size.y()}, uniform(0.05, 0.25));
  for (int i = 0; i < 2; ++i) {
    add_lump(builder_,
             {top.to_world({uniform(-0.3, 0.3) * size.x(), 0.35 * size.y(), 0.02}),
              place.yaw + uniform(-0.4, 0.4)},
             {0.55, 0.4, 0.18});
  }
  builder_.room().sights.push_back(top.position);
}

void TrainingLayout::stairs(const Place& place, double width) {
  const int steps = 3 + builder_.random().below(6);
  const double rise = uniform(0.13, 0.2);
  const double run = uniform(0.24, 0.32);
  for (int i = 0; i < steps; ++i) {
    add_flat(builder_.model(), place.to_world({-0.5 * width, i * run, i * rise}),
             place.turn({width, 0, 0}), {0, 0, rise}, unpainted());
    add_flat(builder_.model(), place.to_world({-0.5 * width, i * run, (i + 1) * rise}),
             place.turn({width, 0, 0}), place.turn({0, run, 0}), unpainted());
  }
  builder_.paint(TileKind::kFloor);
  builder_.room().sights.push_back(place.to_world({0, 0.5 * steps * run, 0.5 * steps * rise}));
}

void TrainingLayout::piece() {
  const bool at_wall = chance(0.55);
  const std::optional<Spot> spot = find_spot(uniform(0.4, 0.9), at_wall);
  if (!spot) return;
  taken_.push_back(*spot);
  const Place& place = spot->place;
  const double r = spot->radius;
  builder_.room().sights.push_back(place.position + Vector3d(0, 0, uniform(0.2, 1.2)));
  const double choice = uniform(0.0, 1.0);
  if (choice < 0.26) {
    table(place, {1.5 * r, r * uniform(0.8, 1.2), uniform(0.4, 1.05)});
  } else if (choice < 0.40) {
    const Vector3d size(1.3 * r, uniform(0.35, 0.65), uniform(0.5, 2.1));
    box(place, size, TileKind::kWood);
    if (size.z() < 1.4) {
      things_on({place.to_world({0, 0, size.z()}), place.yaw}, size, builder_.random().below(6));
    }
  } else if (choice < 0.50) {
    shelf(place, {1.3 * r, uniform(0.25, 0.45), uniform(0.8, 2.0)});
  } else if (choice < 0.60) {
    bed(place, {uniform(0.8, 1.6), uniform(1.4, 2.0), uniform(0.3, 0.55)});
  } else if (choice < 0.68) {
    add_sofa(builder_.model(), place, 2.0 * r, Color::Ones(), 1);
    builder_.paint(TileKind::kCloth);
  } else if (choice < 0.76) {
    add_chair(builder_.model(), place, WoodKind::kOak, 1);
    builder_.paint(chance(0.5) ? TileKind::kWood : TileKind::kCloth);
  } else if (choice < 0.80) {
    stairs(place, uniform(0.7, 1.4));
  } else if (choice < 0.84) {
    tilted_board(place, uniform(0.4, 1.2), uniform(0.5, 1.8));
  } else if (choice < 0.92) {
    add_person(builder_, place);
  } else {
    add_bush(builder_, place, uniform(0.6, 1.5));
  }
}

void TrainingLayout::loose_clutter() {
  const double size = uniform(0.12, 0.7);
  const std::optional<Spot> spot = find_spot(0.6 * size, false);
  if (!spot) return;
  add_small_clutter(builder_, spot->place, size);
  builder_.room().sights.push_back(spot->place.position + Vector3d(0, 0, 0.5 * size));
}

void TrainingLayout::loose_box() {
  const Vector3d size(uniform(0.15, 0.8), uniform(0.15, 0.6), uniform(0.1, 0.8));
  const std::optional<Spot> spot = find_spot(0.6 * size.head<2>().norm(), false);
  if (!spot) return;
  taken_.push_back(*spot);
  box(spot->place, size, chance(0.5) ? TileKind::kObject : TileKind::kWood);
  const Place top{spot->place.to_world({0, 0, size.z()}), spot->place.yaw + uniform(-0.5, 0.5)};
  if (chance(0.3)) box(top, 0.6 * size, TileKind::kObject);
  builder_.room().sights.push_back(top.position);
}

}  // namespace planecast::engine::synth
