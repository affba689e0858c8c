#include "planner/run_planner.h"

#include <chrono>

#include <spdlog/spdlog.h>

#include "common/app/real_time.h"
#include "common/bus/lcm_bus.h"
#include "planner/planner_node.h"
#include "planner/policies/table.h"

namespace roundabout::planner {

int runPlanner(const PlannerOptions& options, app::Context& context) {
  const config::Experiment& experiment = context.experiment;
  auto policy =
      makePolicy(experiment.planner.policy, {"", experiment.planner.orca, experiment.file});
  spdlog::info("{} flies {} on {}", policy->name(), options.vehicle, context.lcm_url);

  if (watchesWallClock(experiment)) {
    app::requestRealTimePriority(app::kPlannerPriority);
  }
  bus::LcmBus bus(context.lcm_url);
  PlannerNode node(experiment, options.vehicle, std::move(policy), bus);
  while (!context.stop.requested()) {
    bus.handle(std::chrono::milliseconds(10));
    node.onWallClock(std::chrono::steady_clock::now());
  }
  return 0;
}

}  // namespace roundabout::planner
