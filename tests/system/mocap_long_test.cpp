// What takes a network, or flies in real time.

#include <gmock/gmock.h>

#include "tests/support/npm.h"
#include "tests/system/mocap_lab.h"

namespace roundabout::test {
namespace {

TEST_F(MocapLab, FliesThroughAnEmulatedMotive) {
  auto& flight = startFlight(twoSwap(), {"--mocap", "natnet", "--no-report"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 0) << testing::PrintToString(ended.lines);
  EXPECT_TRUE(leftRunning().empty());
}

}  // namespace
}  // namespace roundabout::test
