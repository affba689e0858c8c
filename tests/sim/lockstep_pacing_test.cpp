#include "sim/lockstep_pacing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"
#include "common/core/tick_timer.h"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::sim {
namespace {

config::Experiment oneVehicle() {
  config::Experiment experiment;
  experiment.file = "demo.yaml";
  experiment.vehicles.resize(1);
  experiment.vehicles[0].name = "hex1";
  experiment.sim.max_duration_s = 2.0;
  experiment.sim.lockstep_patience_s = 30.0;
  experiment.sim.lockstep_start_s = 0.05;
  experiment.sim.lockstep_max_factor = 1e6;
  return experiment;
}

bool never() { return false; }

/// The simulator's bus, on which everybody else lives too: whoever shall answer does so while the
/// simulator waits.
class BusWithLab final : public bus::Bus {
 public:
  explicit BusWithLab(std::shared_ptr<bus::MemoryNetwork> network) : sim_(network), lab_(network) {
    bus::subscribe<roundabout_msgs::vehicle_states_t>(
        lab_, bus::kStatesChannel,
        [this](const roundabout_msgs::vehicle_states_t& message) { onStates(message.utime); },
        [](const bus::DecodeError&) {});
  }

  void publish(const std::string& channel, std::span<const std::byte> payload) override {
    sim_.publish(channel, payload);
  }
  void subscribe(const std::string& channel, Handler handler) override {
    sim_.subscribe(channel, std::move(handler));
  }
  void subscribePrefix(const std::string& prefix, Handler handler) override {
    sim_.subscribePrefix(prefix, std::move(handler));
  }
  int handle(std::chrono::milliseconds timeout) override {
    // The first call of a wait finds nothing, as on a real network.
    if (timeout.count() > 0) {
      lab_.handle(timeout);
    }
    return sim_.handle(timeout);
  }

  void sayHello() {
    bus::publish(lab_, "PLANNER_STATUS_hex1", roundabout_msgs::planner_status_t{});
    bus::publish(lab_, bus::kFleetStatusChannel, roundabout_msgs::fleet_status_t{});
  }

  bool planner_answers_ = true;
  int commands_ = 0;
  std::vector<core::Utime> frames_;

 private:
  void onStates(core::Utime utime) {
    frames_.push_back(utime);
    if (planner_timer_.due(utime) && planner_answers_) {
      core::Command command;
      command.vehicle = "hex1";
      command.utime = utime;
      command.state_utime = utime;
      command.valid_for_s = 0.3;
      bus::publish(lab_, bus::commandChannel("hex1"), bus::toMessage(command));
      ++commands_;
    }
    if (fleet_timer_.due(utime)) {
      roundabout_msgs::fleet_status_t status{};
      status.utime = utime;
      bus::publish(lab_, bus::kFleetStatusChannel, status);
    }
  }

  bus::MemoryBus sim_;
  bus::MemoryBus lab_;
  core::TickTimer planner_timer_{10.0};
  core::TickTimer fleet_timer_{5.0};
};

class LockstepPacingTest : public testing::Test {
 protected:
  BusWithLab bus_{std::make_shared<bus::MemoryNetwork>()};
  SimNode node_{oneVehicle(), bus_, LockstepPacing::kFirstUtime};
  LockstepPacing pacing_{oneVehicle(), bus_};
};

TEST_F(LockstepPacingTest, NamesWhoIsMissingWhenNobodyStarts) {
  EXPECT_THAT(
      [this] { pacing_.waitForEverybody(never); },
      testing::ThrowsMessage<core::StartupError>(
          "demo.yaml: sim.lockstep_start_s: expected everybody within 0.05 s, found nothing "
          "from planner of hex1, fleet"));
}

TEST_F(LockstepPacingTest, StartsWhenEverybodyWasHeard) {
  bus_.sayHello();
  EXPECT_NO_THROW(pacing_.waitForEverybody(never));
  EXPECT_TRUE(bus_.frames_.empty());
}

TEST_F(LockstepPacingTest, WaitsForTheAnswerToEveryTick) {
  bus_.sayHello();
  pacing_.waitForEverybody(never);
  pacing_.run(node_, never);
  EXPECT_EQ(bus_.commands_, 21);
  EXPECT_EQ(node_.report().frames, 401);
  EXPECT_EQ(node_.rejections().total(), 0);
}

TEST_F(LockstepPacingTest, GoesOnWithoutWhoDoesNotAnswer) {
  config::Experiment impatient = oneVehicle();
  impatient.sim.lockstep_patience_s = 0.02;
  LockstepPacing pacing(impatient, bus_);
  bus_.sayHello();
  pacing.waitForEverybody(never);
  bus_.planner_answers_ = false;
  pacing.run(node_, never);
  EXPECT_EQ(node_.report().frames, 401);
}

TEST_F(LockstepPacingTest, IsNotFasterThanAllowed) {
  config::Experiment experiment = oneVehicle();
  experiment.sim.max_duration_s = 0.5;
  experiment.sim.lockstep_max_factor = 10.0;
  SimNode node(experiment, bus_, LockstepPacing::kFirstUtime);
  LockstepPacing pacing(experiment, bus_);
  const auto begin = std::chrono::steady_clock::now();
  pacing.run(node, never);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(47));
}

TEST_F(LockstepPacingTest, StopsWhenTold) {
  bus_.sayHello();
  pacing_.waitForEverybody(never);
  int asked = 0;
  pacing_.run(node_, [&asked] { return ++asked > 10; });
  EXPECT_LT(node_.report().frames, 11);
}

}  // namespace
}  // namespace roundabout::sim
