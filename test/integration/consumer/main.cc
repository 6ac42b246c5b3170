#include <cstdio>

#include "engine/pipeline/track_sequence.h"

int main(int, char** argv) {
  using namespace planecast::engine;
  const auto sequence = open_sequence(argv[1], SequenceOptions{});
  const Reconstruction map = track_sequence(*sequence, TrackSequenceOptions{}, nullptr);
  std::printf("%zu frames, %zu planes\n", map.frames.size(), map.planes.size());
}
