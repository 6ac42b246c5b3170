#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "engine/assets.h"
#include "engine/evaluate/training_rooms.h"
#include "engine/segmentation/choose_segmenter.h"

namespace planecast::engine {

/// The line "held-out ROOMS: name figure name figure ..." of assets/network/planes.txt.
inline std::map<std::string, double> recorded_figures(int rooms) {
  std::ifstream in(asset("network/planes.txt"));
  const std::string wanted = "held-out " + std::to_string(rooms) + ":";
  std::map<std::string, double> figures;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(wanted, 0) != 0) continue;
    std::istringstream fields(line.substr(wanted.size()));
    std::string name;
    double value = 0.0;
    while (fields >> name >> value) figures[name] = value;
  }
  return figures;
}

/// The committed weights do on held-out rooms what is recorded. Other processors sum in another
/// order, which turns a pixel here and there: `tolerance` is for that.
inline MaskResult expect_recorded_figures(int rooms, double tolerance) {
  const MaskResult result = evaluate_on_rooms(*choose_network({}), kHeldOutRooms, rooms);
  std::map<std::string, double> recorded = recorded_figures(rooms);
  EXPECT_EQ(recorded.size(), 5U) << "assets/network/planes.txt lacks held-out " << rooms;
  EXPECT_NEAR(result.recall, recorded["recall"], tolerance);
  EXPECT_NEAR(result.precision, recorded["precision"], tolerance);
  EXPECT_NEAR(result.rand_index, recorded["RI"], tolerance);
  EXPECT_NEAR(result.variation_of_information, recorded["VOI"], tolerance);
  EXPECT_NEAR(result.segmentation_covering, recorded["SC"], tolerance);
  return result;
}

}  // namespace planecast::engine
