// Draws pictures of training rooms with their truth into one shard:
//   make_training_set OUTPUT FIRST_SEED ROOMS VIEWS_PER_ROOM BANK_SEED
// A shard is a run of samples of fixed size: 192x144 BGR bytes, labels, and normals (127 x, int8).
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>

#include "engine/sequence/synth/training_picture.h"

namespace {

using namespace planecast::engine::synth;

void write(std::ofstream& out, const cv::Mat& image) {
  out.write(reinterpret_cast<const char*>(image.data),
            static_cast<std::streamsize>(image.total() * image.elemSize()));
}

int make(char** argv) {
  const std::uint64_t first = std::strtoull(argv[2], nullptr, 10);
  const std::uint64_t rooms = std::strtoull(argv[3], nullptr, 10);
  const std::uint64_t views = std::strtoull(argv[4], nullptr, 10);
  TileBank bank(std::strtoull(argv[5], nullptr, 10));
  std::ofstream out(argv[1], std::ios::binary);
  double non_planar = 0.0;
  for (std::uint64_t seed = first; seed < first + rooms; ++seed) {
    const TrainingRoom room = make_training_room(seed, bank);
    TrainingPainter painter(room, bank, seed);
    for (std::uint64_t view = 0; view < views; ++view) {
      const TrainingSample sample = painter.draw(view_seed(seed, view));
      write(out, sample.bgr);
      write(out, sample.labels);
      write(out, sample.normals);
      non_planar += sample.non_planar;
    }
  }
  out.close();
  if (!out) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 2;
  }
  std::printf("%s: rooms %s+%s, %s views each, %.1f %% of the pixels not planar\n", argv[1],
              argv[2], argv[3], argv[4], 100.0 * non_planar / static_cast<double>(rooms * views));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr,
                 "usage: make_training_set OUTPUT FIRST_SEED ROOMS VIEWS_PER_ROOM BANK_SEED\n");
    return 2;
  }
  try {
    return make(argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
