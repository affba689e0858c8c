#include "cli/nobody_flies.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/lcm_bus.h"
#include "common/core/error.h"
#include "tests/support/lcm_url.h"

namespace roundabout::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Somebody who speaks on channels, on the test's URL, until the test is over.
class NobodyFliesTest : public testing::Test {
 protected:
  NobodyFliesTest() { experiment_.vehicles.emplace_back().name = "hex1"; }

  std::jthread speak(const std::vector<std::string>& channels) const {
    return std::jthread([channels, url = url_](const std::stop_token& stop) {
      bus::LcmBus bus(url);
      while (!stop.stop_requested()) {
        for (const std::string& channel : channels) {
          bus.publish(channel, {});
        }
        bus.handle(std::chrono::milliseconds(100));
      }
    });
  }

  std::string url_ = test::ownLcmUrl();
  config::Experiment experiment_;
};

TEST_F(NobodyFliesTest, IsSoOnAUrlOfOnesOwn) { requireNobodyFlies(experiment_, url_); }

TEST_F(NobodyFliesTest, IsNotSoWhereAPlannerOrAFleetWaits) {
  const std::jthread somebody = speak({"PLANNER_STATUS_hex1", "FLEET_STATUS"});
  try {
    requireNobodyFlies(experiment_, url_);
    FAIL() << "overheard them";
  } catch (const core::StartupError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("found FLEET_STATUS, PLANNER_STATUS_hex1"),
                                    HasSubstr(url_), Not(HasSubstr("VEHICLE_STATES"))));
  }
}

TEST_F(NobodyFliesTest, IsNotSoWhereStatesAreSent) {
  const std::jthread somebody = speak({"VEHICLE_STATES"});
  EXPECT_THROW(requireNobodyFlies(experiment_, url_), core::StartupError);
}

TEST_F(NobodyFliesTest, IsSoBesideSomebodyWhoOnlyTalksOfOtherThings) {
  const std::jthread somebody = speak({"PLANNER_STATUS_hex9", "LOG_MARKER"});
  requireNobodyFlies(experiment_, url_);
}

}  // namespace
}  // namespace roundabout::cli
