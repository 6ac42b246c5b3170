#include "engine/output/planes_json.h"
#include "engine/output/ply.h"
#include "engine/output/summary.h"
#include "engine/output/tables.h"
#include "engine/pipeline/map_bin.h"
#include "engine/scene/plane_outline.h"
#include "slam/data/byte_stream.h"
#include "test/fuzz/memory_file.h"
#include "test/fuzz/target.h"

namespace planecast::fuzz {

/// The bytes are what follows the header: no mutation would get past the checksum.
void read_map(std::string_view bytes) {
  const std::uint32_t version = 2;
  slam::ByteWriter header;
  for (const char c : std::string_view("PLNCMAP\0", 8)) header.put(c);
  header.put(version);
  header.put(static_cast<std::uint64_t>(bytes.size()));
  header.put(slam::checksum_of(bytes));
  const std::string& file = memory_file(header.bytes() + std::string(bytes));
  for (const bool with_map : {true, false}) {
    answer([&] {
      engine::Reconstruction reconstruction;
      engine::read_map_bin(file, reconstruction, with_map);
    });
  }
}

void read_planes(std::string_view bytes) {
  answer([&] {
    for (const engine::PlaneRecord& plane : engine::read_planes_json(memory_file(bytes)).planes) {
      engine::plane_outline(plane);
    }
  });
}

/// The first byte says which.
void read_tables(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string& file = memory_file(bytes.substr(1));
  answer([&] {
    switch (static_cast<unsigned char>(bytes[0]) % 5) {
      case 0:
        engine::read_frames_csv(file);
        break;
      case 1:
        engine::read_times_csv(file);
        break;
      case 2:
        engine::read_timings_json(file);
        break;
      case 3:
        engine::read_plane_rms(file);
        break;
      default:
        engine::read_ply(file);
    }
  });
}

}  // namespace planecast::fuzz
