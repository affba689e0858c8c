#include "common/bus/listen.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"

namespace roundabout::bus {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

class ListenTest : public testing::Test {
 protected:
  ListenTest() {
    // Whoever listens is spoken to.
    listener_.subscribe("X", [this](const Received&) { listener_.publish("Z", {}); });
    listener_.publish("X", {});
  }

  MemoryBus listener_{std::make_shared<MemoryNetwork>()};
};

TEST_F(ListenTest, NamesTheChannelsOnWhichSomebodySpoke) {
  EXPECT_THAT(heardWithin(milliseconds(5), listener_, {"X", "Y", "Z"}), ElementsAre("X", "Z"));
}

TEST_F(ListenTest, HearsNobodyInAnEmptyLab) {
  EXPECT_THAT(heardWithin(milliseconds(1), listener_, {"Y"}), IsEmpty());
}

TEST_F(ListenTest, WaitsNoLongerThanUntilAllAreHeard) {
  EXPECT_THAT(heardWithin(std::chrono::hours(1), listener_, {"X", "Z"}), ElementsAre("X", "Z"));
}

}  // namespace
}  // namespace roundabout::bus
