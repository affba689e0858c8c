#include "perception/perception_node.h"

#include <spdlog/spdlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"

namespace roundabout::perception {

using Clock = std::chrono::steady_clock;

PerceptionNode::PerceptionNode(const config::Experiment& experiment, const std::string& vehicle,
                               std::unique_ptr<PersonDetector> detector, bus::Bus& bus)
    : core_(experiment, vehicle, std::move(detector)), bus_(bus) {
  subscribe();
}

void PerceptionNode::subscribe() {
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      bus_, bus::kStatesChannel,
      [this](const roundabout_msgs::vehicle_states_t& message) {
        const auto begin = Clock::now();
        bus::fromMessage(message, frame_);
        if (const char* reason = core_.onFrame(frame_)) {
          logRejection(bus::kStatesChannel, reason);
        }
        publish(begin);
      },
      [this](const bus::DecodeError& error) {
        core_.onBrokenPose();
        logRejection(error.channel, error.reason);
      });
  const std::string channel = bus::laserScanChannel(core_.vehicle().name);
  bus::subscribe<roundabout_msgs::planar_lidar_t>(
      bus_, channel,
      [this, channel,
       scan = core::LaserScan()](const roundabout_msgs::planar_lidar_t& message) mutable {
        const auto begin = Clock::now();
        if (const char* reason = bus::fromMessage(message, scan)) {
          core_.onBrokenScan();
          logRejection(channel, reason);
        } else if (const char* refusal = core_.onScan(scan)) {
          logRejection(channel, refusal);
        }
        publish(begin);
      },
      [this](const bus::DecodeError& error) {
        core_.onBrokenScan();
        logRejection(error.channel, error.reason);
      });
  for (std::size_t i = 0; i < core_.vehicle().cameras.size(); ++i) {
    subscribeCamera(i);
  }
}

void PerceptionNode::subscribeCamera(std::size_t camera) {
  if (core_.vehicle().cameras[camera].depth) {
    subscribeImages<core::DepthImage>(camera, &PerceptionCore::onDepths);
  } else {
    subscribeImages<core::JpegImage>(camera, &PerceptionCore::onImage);
  }
}

template <class Image>
void PerceptionNode::subscribeImages(std::size_t camera,
                                     const char* (PerceptionCore::*on_image)(std::size_t,
                                                                             const Image&)) {
  const std::string channel =
      bus::imageChannel(core_.vehicle().name, core_.vehicle().cameras[camera].name);
  bus::subscribe<roundabout_msgs::image_t>(
      bus_, channel,
      [this, channel, camera, on_image,
       image = Image()](const roundabout_msgs::image_t& message) mutable {
        if (const char* reason = bus::fromMessage(message, image)) {
          core_.onBrokenImage();
          logRejection(channel, reason);
        } else if (const char* refusal = (core_.*on_image)(camera, image)) {
          logRejection(channel, refusal);
        }
      },
      [this](const bus::DecodeError& error) {
        core_.onBrokenImage();
        logRejection(error.channel, error.reason);
      });
}

void PerceptionNode::announce() {
  if (frame_.utime != 0) {
    return;
  }
  core::AgentTracks nothing;
  nothing.vehicle = core_.vehicle().name;
  nothing.health = core::PerceptionHealth::kBlind;
  nothing.reason = "no vehicle states yet";
  bus::publish(bus_, bus::agentTracksChannel(nothing.vehicle), bus::toMessage(nothing));
}

void PerceptionNode::publish(Clock::time_point begin) {
  // First: who has the tracks of a sweep has the map that was known then.
  if (const auto map = core_.takeMap()) {
    bus::publish(bus_, bus::occupancyChannel(core_.vehicle().name), bus::toMessage(*map));
  }
  while (auto tracks = core_.takeTracks()) {
    tracks->compute_time_s = std::chrono::duration<double>(Clock::now() - begin).count();
    bus::publish(bus_, bus::agentTracksChannel(core_.vehicle().name), bus::toMessage(*tracks));
    logHealth(*tracks);
  }
}

void PerceptionNode::logRejection(std::string_view channel, const char* reason) {
  if (rejections_logged_.emplace(channel, reason).second) {
    spdlog::warn("a message on {} was rejected: {}; further ones are only counted", channel,
                 reason);
  }
}

void PerceptionNode::logHealth(const core::AgentTracks& tracks) {
  if (tracks.reason != logged_health_) {
    logged_health_ = tracks.reason;
    spdlog::log(tracks.reason.empty() ? spdlog::level::info : spdlog::level::warn, "{}",
                tracks.reason.empty() ? "sees well" : tracks.reason);
  }
}

}  // namespace roundabout::perception
