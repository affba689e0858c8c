#include "perception/run_perception.h"

#include <algorithm>
#include <chrono>

#include <spdlog/spdlog.h>

#include "common/app/real_time.h"
#include "common/bus/lcm_bus.h"
#include "perception/perception_node.h"

namespace roundabout::perception {

int runPerception(const PerceptionOptions& options, app::Context& context) {
  const config::Experiment& experiment = context.experiment;
  const config::Perception& settings = experiment.perception;
  auto detector = makePersonDetector(settings, experiment.file);
  const std::string eyes = detector ? detector->name() : "nothing";
  const double picture_s = detector ? detector->pictureS() : 0.0;
  app::requestRealTimePriority(app::kPlannerPriority);
  bus::LcmBus bus(context.lcm_url);
  // The bus's own thread is to be on time, those that look at images and keep the map are not.
  app::keepRealTimePriorityToThisThread();
  PerceptionNode node(experiment, options.vehicle, std::move(detector), bus);
  const config::Vehicle& vehicle = node.core().vehicle();
  spdlog::info("{} sees by {}, and in pictures of {} cameras by {}, on {}", options.vehicle,
               settings.clusterer, vehicle.cameras.size(), eyes, context.lcm_url);
  const auto looked_at = std::count_if(vehicle.cameras.begin(), vehicle.cameras.end(),
                                       [](const auto& camera) { return !camera.depth; });
  if (const std::string why = whyTooSlow(picture_s, static_cast<std::size_t>(looked_at), settings);
      !why.empty()) {
    spdlog::warn("{}", why);
  }
  constexpr std::chrono::milliseconds kAnnouncements{200};
  auto next_announcement = std::chrono::steady_clock::now();
  while (!context.stop.requested()) {
    bus.handle(std::chrono::milliseconds(20));
    if (std::chrono::steady_clock::now() >= next_announcement) {
      node.announce();
      next_announcement += kAnnouncements;
    }
  }
  if (!node.core().saveMap()) {
    spdlog::error("{} cannot be written", settings.map_file);
    return 1;
  }
  return 0;
}

}  // namespace roundabout::perception
