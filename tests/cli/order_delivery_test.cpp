#include "cli/order_delivery.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/command_t.hpp"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::cli {
namespace {

using core::SafetyOrderKind;
using roundabout_msgs::planner_status_t;
using roundabout_msgs::safety_order_t;
using testing::ElementsAre;
using testing::IsEmpty;

/// Planners that answer on the operator's own bus: who publishes there hears itself.
class OrderDeliveryTest : public testing::Test {
 protected:
  OrderDeliveryTest() {
    bus::subscribe<safety_order_t>(
        bus_, bus::kSafetyOrderChannel,
        [this](const safety_order_t& order) {
          stamps_.push_back(order.utime);
          for (auto& [name, planner] : planners_) {
            answer(name, planner, order);
          }
        },
        [](const bus::DecodeError&) { FAIL() << "the operator sent garbage"; });
  }

  struct FakePlanner {
    std::int8_t obedient_mode = planner_status_t::HOLDING;
    int orders_lost = 0;
  };

  void answer(const std::string& name, FakePlanner& planner, const safety_order_t& order) {
    planner_status_t status{};
    status.vehicle = name;
    status.mode = planner_status_t::FLYING;
    if (planner.orders_lost-- <= 0 && (order.vehicle.empty() || order.vehicle == name)) {
      status.mode = planner.obedient_mode;
      status.reason = "ordered";
      status.order_utime = order.utime;
    }
    bus::publish(bus_, bus::plannerStatusChannel(name), status);
  }

  Delivery order(SafetyOrderKind kind, const std::string& vehicle = "") {
    return deliver(bus_, {kOrderTime, vehicle, kind},
                   {.listen_s = 0.01, .answer_s = 0.05, .repeat_s = 0.002});
  }

  static constexpr core::Utime kOrderTime = 1'700'000'000'000'000;
  bus::MemoryBus bus_{std::make_shared<bus::MemoryNetwork>()};
  std::map<std::string, FakePlanner> planners_;
  std::vector<core::Utime> stamps_;
};

TEST_F(OrderDeliveryTest, SaysWhoObeyed) {
  planners_ = {{"hex1", {}}, {"hex2", {}}};
  const Delivery delivery = order(SafetyOrderKind::kHold);
  EXPECT_TRUE(delivery.complete());
  EXPECT_THAT(delivery.obeyed, ElementsAre("hex1: holding, ordered", "hex2: holding, ordered"));
}

TEST_F(OrderDeliveryTest, RepeatsTheSameOrderUntilTheLastHasHeardIt) {
  planners_ = {{"hex1", {}}, {"hex2", {.orders_lost = 3}}};
  EXPECT_TRUE(order(SafetyOrderKind::kHold).complete());
  ASSERT_GE(stamps_.size(), 4U);
  EXPECT_THAT(stamps_, testing::Each(kOrderTime));
}

TEST_F(OrderDeliveryTest, RepeatsNothingOnceEverybodyObeys) {
  planners_ = {{"hex1", {}}};
  order(SafetyOrderKind::kHold);
  EXPECT_EQ(stamps_.size(), 1U);
}

TEST_F(OrderDeliveryTest, NamesWhoDoesNotObey) {
  planners_ = {{"hex1", {}}, {"hex2", {.orders_lost = 1'000'000}}};
  const Delivery delivery = order(SafetyOrderKind::kHold);
  EXPECT_THAT(delivery.obeyed, ElementsAre("hex1: holding, ordered"));
  EXPECT_THAT(delivery.problems, ElementsAre("hex2 does not obey: flying"));
}

TEST_F(OrderDeliveryTest, SaysThatNobodyAnswered) {
  EXPECT_THAT(order(SafetyOrderKind::kLand).problems, ElementsAre("no planner answered"));
  EXPECT_GT(stamps_.size(), 1U);
}

TEST_F(OrderDeliveryTest, NamesTheVehiclesThatThereAreWhenOneIsMisspelt) {
  planners_ = {{"hex1", {}}, {"hex2", {}}};
  const Delivery delivery = order(SafetyOrderKind::kKill, "hxe2");
  EXPECT_THAT(delivery.obeyed, IsEmpty());
  EXPECT_THAT(delivery.problems, ElementsAre("no vehicle hxe2 (heard: hex1, hex2)"));
}

TEST_F(OrderDeliveryTest, WaitsForTheAddressedVehicleOnly) {
  planners_ = {{"hex1", {}}, {"hex2", {.orders_lost = 1'000'000}}};
  EXPECT_THAT(order(SafetyOrderKind::kHold, "hex1").obeyed, ElementsAre("hex1: holding, ordered"));
}

TEST_F(OrderDeliveryTest, TakesNoKillForObeyedUntilTheMotorsAreOff) {
  planners_ = {{"hex1", {.obedient_mode = planner_status_t::WAITING}}};
  EXPECT_THAT(order(SafetyOrderKind::kKill).problems,
              ElementsAre("hex1 does not obey: waiting, ordered"));
  planners_ = {{"hex1", {.obedient_mode = planner_status_t::KILLED}}};
  EXPECT_TRUE(order(SafetyOrderKind::kKill).complete());
}

TEST_F(OrderDeliveryTest, AKillReachesAVehicleWithoutAPlanner) {
  bus_.subscribe(bus::kSafetyOrderChannel, [this](const bus::Received&) {
    core::StatesFrame frame;
    frame.vehicles.resize(1);
    frame.vehicles[0].name = "hex3";
    bus::publish(bus_, bus::kStatesChannel, bus::toMessage(frame));
  });
  int kills = 0;
  bus::subscribe<roundabout_msgs::command_t>(
      bus_, bus::commandChannel("hex3"),
      [&](const roundabout_msgs::command_t& command) {
        kills += command.vehicle == "hex3" && command.mode == roundabout_msgs::command_t::KILL;
      },
      [](const bus::DecodeError&) { FAIL(); });
  EXPECT_FALSE(order(SafetyOrderKind::kKill).complete());
  EXPECT_GT(kills, 0);
  kills = 0;
  order(SafetyOrderKind::kLand);
  EXPECT_EQ(kills, 0);
}

TEST_F(OrderDeliveryTest, AnOrderThatANewerOneHasOvertakenIsNotRepeated) {
  bus_.subscribe(bus::kSafetyOrderChannel, [this](const bus::Received&) {
    planner_status_t status{};
    status.vehicle = "hex1";
    status.mode = planner_status_t::LANDING;
    status.order_utime = kOrderTime + 1;
    bus::publish(bus_, bus::plannerStatusChannel("hex1"), status);
  });
  EXPECT_TRUE(order(SafetyOrderKind::kHold).complete());
  EXPECT_LE(stamps_.size(), 2u);
}

TEST_F(OrderDeliveryTest, MissesAVehicleWhosePlannerIsDead) {
  planners_ = {{"hex1", {}}};
  bus_.subscribe(bus::kSafetyOrderChannel, [this](const bus::Received&) {
    roundabout_msgs::fleet_status_t fleet{};
    fleet.vehicles.resize(2);
    fleet.vehicles[0].vehicle = "hex1";
    fleet.vehicles[1].vehicle = "hex2";
    fleet.num_vehicles = 2;
    bus::publish(bus_, bus::kFleetStatusChannel, fleet);
    core::StatesFrame frame;
    frame.vehicles.resize(1);
    frame.vehicles[0].name = "hex3";
    bus::publish(bus_, bus::kStatesChannel, bus::toMessage(frame));
  });
  EXPECT_THAT(order(SafetyOrderKind::kLand).problems,
              ElementsAre("hex2: its planner is not heard", "hex3: its planner is not heard"));
}

}  // namespace
}  // namespace roundabout::cli
