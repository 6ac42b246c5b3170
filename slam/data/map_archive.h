#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "slam/data/byte_stream.h"
#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {

/// A map as bytes, to the bit: keyframes with features, descriptors and landmarks, landmarks with
/// observations, planes, and what is remembered of erased keyframes and replaced landmarks. Left
/// out are images (pyramids, depth, masks) and bags of words, which can be made again.
class MapArchive {
 public:
  static std::string encode(const Map& map);
  /// `camera` bounds the features' grid. Nothing where the bytes are no map or break its
  /// invariants.
  static std::optional<Map> decode(std::string_view bytes, const Camera& camera);

 private:
  static void put(const Keyframe& keyframe, ByteWriter& out);
  static void put(const Landmark& landmark, ByteWriter& out);
  static void put(const Plane& plane, ByteWriter& out);
  static Keyframe take_keyframe(ByteReader& in, const Camera& camera);
  static Landmark take_landmark(ByteReader& in);
  static Plane take_plane(ByteReader& in);
  static void put_history(const Map& map, ByteWriter& out);
  static void take_history(ByteReader& in, Map& map);
  static bool is_sound(const Map& map);
  static bool history_is_sound(const Map& map);
};

}  // namespace planecast::slam
