#include "sim/lockstep_pacing.h"

#include <algorithm>
#include <thread>

#include <spdlog/spdlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"
#include "roundabout_msgs/agent_tracks_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::sim {

namespace {

// How late a stop may be noticed.
constexpr std::chrono::milliseconds kGlance{50};
constexpr std::chrono::seconds kReminderPeriod{5};
// Time lost waiting is made up for by a short burst of frames, not by a long one: stock receivers
// lose what comes while 30 messages wait for them.
constexpr std::chrono::microseconds kLongestCatchUp{500};

// The node counts what cannot be decoded.
void ignore(const bus::DecodeError& /*error*/) {}

}  // namespace

LockstepPacing::LockstepPacing(const config::Experiment& experiment, bus::Bus& bus)
    : experiment_(experiment),
      bus_(bus),
      barrier_(experiment.vehicles.size(), experiment.planner.rate_hz, experiment.fleet.rate_hz) {
  subscribe();
}

void LockstepPacing::subscribe() {
  for (std::size_t i = 0; i < experiment_.vehicles.size(); ++i) {
    const std::string& name = experiment_.vehicles[i].name;
    bus::subscribe<roundabout_msgs::planner_status_t>(
        bus_, bus::plannerStatusChannel(name),
        [this, i](const roundabout_msgs::planner_status_t&) { barrier_.heard(i); }, ignore);
    bus::subscribe<roundabout_msgs::command_t>(
        bus_, bus::commandChannel(name),
        [this, i](const roundabout_msgs::command_t& command) {
          barrier_.answered(i, command.state_utime);
        },
        ignore);
  }
  bus::subscribe<roundabout_msgs::fleet_status_t>(
      bus_, bus::kFleetStatusChannel,
      [this](const roundabout_msgs::fleet_status_t& status) {
        barrier_.answered(barrier_.fleet(), status.utime);
      },
      ignore);
  subscribeWatchers();
}

void LockstepPacing::subscribeWatchers() {
  for (std::size_t i = 0; i < experiment_.vehicles.size(); ++i) {
    if (config::seesForItself(experiment_, experiment_.vehicles[i])) {
      watchers_.push_back({i});
    }
  }
  for (Watcher& watcher : watchers_) {
    bus::subscribe<roundabout_msgs::agent_tracks_t>(
        bus_, bus::agentTracksChannel(experiment_.vehicles[watcher.vehicle].name),
        [&watcher](const roundabout_msgs::agent_tracks_t& tracks) {
          watcher.present = true;
          watcher.newest = std::max(watcher.newest, tracks.utime);
        },
        ignore);
  }
}

bool LockstepPacing::awaited(const Watcher& watcher, const SimNode& node) {
  const core::Utime scan = node.sensors().newestScan(watcher.vehicle);
  return watcher.present && scan > 0 && scan <= node.newestPose(watcher.vehicle) &&
         watcher.newest < scan;
}

bool LockstepPacing::everybodyPresent() const {
  return barrier_.absent().empty() &&
         std::all_of(watchers_.begin(), watchers_.end(),
                     [](const Watcher& watcher) { return watcher.present; });
}

std::string LockstepPacing::absentNames() const {
  std::string names = namesOf(barrier_.absent());
  for (const Watcher& watcher : watchers_) {
    if (!watcher.present) {
      names += (names.empty() ? "" : ", ") +
               ("perception of " + experiment_.vehicles[watcher.vehicle].name);
    }
  }
  return names;
}

void LockstepPacing::waitForEverybody(const std::function<bool()>& stop) {
  const auto begin = Clock::now();
  auto reminder = begin + kReminderPeriod;
  while (!everybodyPresent() && !stop()) {
    const auto now = Clock::now();
    if (std::chrono::duration<double>(now - begin).count() > experiment_.sim.lockstep_start_s) {
      throw core::StartupError(
          experiment_.file, "sim.lockstep_start_s",
          fmt::format("everybody within {} s", experiment_.sim.lockstep_start_s),
          "nothing from " + absentNames());
    }
    if (now > reminder) {
      spdlog::info("waiting for {}", absentNames());
      reminder = now + kReminderPeriod;
    }
    bus_.handle(kGlance);
  }
}

void LockstepPacing::run(SimNode& node, const std::function<bool()>& stop) {
  const auto least_interval =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
          core::toSeconds(node.frameIntervalUs()) / experiment_.sim.lockstep_max_factor));
  auto earliest = Clock::now();
  while (!node.finished() && !stop()) {
    std::this_thread::sleep_until(earliest);
    earliest = std::max(earliest + least_interval, Clock::now() - kLongestCatchUp);
    node.advance();
    barrier_.onFrame(node.nextFrameUtime());
    node.publishFrame();
    awaitAnswers(node, stop);
  }
}

void LockstepPacing::awaitAnswers(const SimNode& node, const std::function<bool()>& stop) {
  const auto sees = [&] {
    return std::none_of(watchers_.begin(), watchers_.end(),
                        [&](const Watcher& watcher) { return awaited(watcher, node); });
  };
  const auto begin = Clock::now();
  bus_.handle(std::chrono::milliseconds(0));
  while (!(barrier_.complete() && sees()) && !stop()) {
    if (std::chrono::duration<double>(Clock::now() - begin).count() >
        experiment_.sim.lockstep_patience_s) {
      std::string names = namesOf(barrier_.awaited());
      for (Watcher& watcher : watchers_) {
        if (awaited(watcher, node)) {
          names += (names.empty() ? "" : ", ") +
                   ("perception of " + experiment_.vehicles[watcher.vehicle].name);
          watcher.present = false;
        }
      }
      spdlog::warn("no answer from {}: going on without", names);
      barrier_.giveUp();
      return;
    }
    bus_.handle(kGlance);
  }
}

std::string LockstepPacing::namesOf(const std::vector<std::size_t>& participants) const {
  std::string names;
  for (const std::size_t participant : participants) {
    names += names.empty() ? "" : ", ";
    names += participant == barrier_.fleet()
                 ? "fleet"
                 : "planner of " + experiment_.vehicles[participant].name;
  }
  return names;
}

}  // namespace roundabout::sim
