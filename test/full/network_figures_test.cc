#include <gtest/gtest.h>

#include "network_figures.h"

namespace planecast::engine {
namespace {

/// What issue 5 asks of the network, on rooms that were fixed before it was trained.
TEST(PlaneNetwork, DoesOnAllHeldOutRoomsWhatIsRecorded) {
  const MaskResult result = expect_recorded_figures(500, 0.01);
  EXPECT_EQ(result.frames, 500);
  EXPECT_GE(result.recall, 0.70);
  EXPECT_GE(result.rand_index, 0.85);
  EXPECT_GE(result.segmentation_covering, 0.75);
  EXPECT_LE(result.variation_of_information, 0.75);
}

}  // namespace
}  // namespace planecast::engine
