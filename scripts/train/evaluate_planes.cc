// Figures of a network on rooms that it was not trained on, which are drawn on the fly:
//   evaluate_planes NETWORK.onnx [validation|held-out [ROOMS]]
// The last line is what assets/network/planes.txt records.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "engine/evaluate/training_rooms.h"
#include "engine/segmentation/network_file.h"

namespace {

using namespace planecast;

void evaluate(const std::string& network, const std::string& set, int rooms) {
  const auto segmenter = engine::read_network(network);
  const bool held_out = set == "held-out";
  const engine::MaskResult result = engine::evaluate_on_rooms(
      *segmenter, held_out ? engine::kHeldOutRooms : engine::kValidationRooms, rooms);
  std::printf("%s on %s rooms\n%s", segmenter->name().c_str(), set.c_str(),
              engine::format_table(result).c_str());
  std::printf("%s %d: recall %.3f precision %.3f RI %.3f VOI %.3f SC %.3f\n", set.c_str(), rooms,
              result.recall, result.precision, result.rand_index, result.variation_of_information,
              result.segmentation_covering);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string set = argc > 2 ? argv[2] : "held-out";
  const int rooms = argc > 3 ? std::atoi(argv[3]) : 500;
  if (argc < 2 || argc > 4 || rooms < 1 || (set != "held-out" && set != "validation")) {
    std::fprintf(stderr, "usage: evaluate_planes NETWORK.onnx [validation|held-out [ROOMS]]\n");
    return 2;
  }
  try {
    evaluate(argv[1], set, rooms);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
