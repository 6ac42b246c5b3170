#include <gtest/gtest.h>

#include "network_figures.h"

namespace planecast::engine {
namespace {

/// Rooms that were fixed before the network was trained.
TEST(PlaneNetwork, DoesOnAllHeldOutRoomsWhatIsRecorded) {
  const MaskResult result = expect_recorded_figures(500, 0.01);
  EXPECT_EQ(result.frames, 500);
}

}  // namespace
}  // namespace planecast::engine
