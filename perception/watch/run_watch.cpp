#include "perception/watch/run_watch.h"

#include <chrono>
#include <cstdlib>

#include <spdlog/spdlog.h>

#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/tick_timer.h"
#include "perception/perception_node.h"
#include "perception/watch/silent_bus.h"
#include "perception/watch/top_view.h"

namespace roundabout::perception {

namespace {

constexpr double kPicturesPerSecond = 10.0;

bool hasDisplay() {
  return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
}

void rememberImages(bus::Bus& bus, const config::Vehicle& vehicle, Sight& sight) {
  for (const config::Camera& camera : vehicle.cameras) {
    bus::subscribe<roundabout_msgs::image_t>(
        bus, bus::imageChannel(vehicle.name, camera.name),
        [&sight, name = camera.name](const roundabout_msgs::image_t& message) {
          core::JpegImage image;
          core::DepthImage depths;
          if (bus::fromMessage(message, image) == nullptr) {
            sight.images[name] = std::move(image);
          } else if (bus::fromMessage(message, depths) == nullptr) {
            sight.depths[name] = std::move(depths);
          }
        },
        [](const bus::DecodeError& /*counted by the node*/) {});
  }
}

}  // namespace

int runWatch(const WatchOptions& options, app::Context& context) {
  const config::Experiment& experiment = context.experiment;
  const config::Perception& settings = experiment.perception;
  auto detector = makePersonDetector(settings, experiment.file);
  TopView view(experiment.room, options.record, !options.no_window && hasDisplay());
  bus::LcmBus bus(context.lcm_url);
  Sight sight;
  core::TickTimer pictures(kPicturesPerSecond);
  core::Utime first = 0;
  PerceptionNode* seeing = nullptr;
  SilentBus silent(bus, [&](const std::string& channel) {
    if (!channel.starts_with(bus::kAgentTracksPrefix) || seeing == nullptr) {
      return;
    }
    sight.utime = seeing->core().finder().points().utime;
    first = first == 0 ? sight.utime : first;
    if (sight.utime != 0 && pictures.due(sight.utime)) {
      sight.finder = &seeing->core().finder();
      sight.cells = seeing->core().cells();
      sight.boxes = seeing->core().boxes();
      view.draw(sight);
    }
  });
  PerceptionNode node(experiment, options.vehicle, std::move(detector), silent);
  seeing = &node;
  rememberImages(bus, node.core().vehicle(), sight);
  spdlog::info("watches what {} sees on {}{}", options.vehicle, context.lcm_url,
               options.record.empty() ? "" : ", into " + options.record);
  while (!context.stop.requested() &&
         (options.seconds <= 0.0 || core::toSeconds(sight.utime - first) < options.seconds)) {
    bus.handle(std::chrono::milliseconds(20));
  }
  if (!options.picture.empty() && !view.save(options.picture)) {
    spdlog::error("{} cannot be written", options.picture);
    return 1;
  }
  spdlog::info("{} pictures", view.pictures());
  return 0;
}

}  // namespace roundabout::perception
