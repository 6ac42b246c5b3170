#pragma once

#include <cstdint>

#include "engine/sequence/synth/prints.h"
#include "engine/sequence/synth/room_model.h"

namespace planecast::engine::synth {

/// Woods used for floors and furniture.
enum class WoodKind { kOak, kWalnut, kPine, kWhite };
Texture furniture_wood(WoodKind kind, std::uint32_t seed);
Texture parquet(WoodKind kind, std::uint32_t seed);
/// A print of the given size in metres, about 1,000 texels a metre.
Texture print(PrintKind kind, double width_m, double height_m, std::uint64_t seed);

/// A table of size (x, y, height); what lies flat on it is in `top_decals`.
void add_table(RoomModel& model, const Place& place, const Eigen::Vector3d& size, WoodKind wood,
               std::vector<Decal> top_decals, std::uint32_t seed);
void add_chair(RoomModel& model, const Place& place, WoodKind wood, std::uint32_t seed);
/// A cabinet with doors on its front.
void add_cabinet(RoomModel& model, const Place& place, const Eigen::Vector3d& size, WoodKind wood,
                 int doors, std::uint32_t seed);
/// Open shelves filled with books and things.
void add_bookshelf(RoomModel& model, const Place& place, const Eigen::Vector3d& size, WoodKind wood,
                   int shelves, std::uint64_t seed);
void add_sofa(RoomModel& model, const Place& place, double width, const Color& color,
              std::uint32_t seed);

/// Books lying on each other.
void add_book_stack(RoomModel& model, const Place& place, int books, std::uint64_t seed);
/// Books standing side by side over `width` metres; returns the width that they took.
double add_book_row(RoomModel& model, const Place& place, double width, double height, double depth,
                    std::uint64_t seed);
void add_mug(RoomModel& model, const Place& place, const Color& color, std::uint32_t seed);
void add_fruit_bowl(RoomModel& model, const Place& place, std::uint64_t seed);
void add_vase(RoomModel& model, const Place& place, const Color& color, std::uint64_t seed);
/// A potted plant with `leaves` bent leaves of about `leaf_m` length.
void add_plant(RoomModel& model, const Place& place, double pot_m, int leaves, double leaf_m,
               std::uint64_t seed);
/// A lamp on a foot with a glowing shade; gives light.
void add_lamp(RoomModel& model, const Place& place, double height, double shade_m,
              std::uint32_t seed);
void add_pencil(RoomModel& model, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                const Color& color);
/// A cardboard or toy box with a print on each side; below the size of a labelled face.
void add_toy_block(RoomModel& model, const Place& place, double size, std::uint64_t seed);
/// A curtain hanging from `from` to `to` (a rail), `drop` metres long.
void add_curtain(RoomModel& model, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                 double drop, const Color& color, std::uint32_t seed);

}  // namespace planecast::engine::synth
