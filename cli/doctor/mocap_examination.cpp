#include "cli/doctor/mocap_examination.h"

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

#include <poll.h>
#include <spdlog/fmt/fmt.h>

#include "common/bus/memory_bus.h"
#include "common/core/error.h"
#include "mocap_bridge/bridge_node.h"
#include "mocap_bridge/local_clock.h"
#include "mocap_bridge/make_source.h"

namespace roundabout::cli {

namespace {

constexpr const char* kWhat = "motion capture";
// A session says after 2 s what it waits for.
constexpr core::Utime kPatience = 3 * core::kMicrosPerSecond;

/// What a bridge that nobody hears says of the system.
class Trial {
 public:
  explicit Trial(const config::Experiment& experiment)
      : bus_(std::make_shared<bus::MemoryNetwork>()),
        node_(experiment, listening(experiment, clock_), mocap_bridge::usualAxes(experiment),
              bus_) {}

  void run() {
    core::Utime since = clock_.now();
    while (!node_.setUpChecked() && clock_.now() - since < kPatience) {
      const core::Utime now = clock_.now();
      node_.poll(now);
      for (std::string& note : node_.takeNotes()) {
        (node_.setUpChecked() ? set_up_ : before_).push_back(std::move(note));
      }
      if (first_ == 0 && framesHeard() > 0) {
        since = first_ = now;
      }
      std::vector<pollfd> descriptors;
      node_.addDescriptors(descriptors);
      poll(descriptors.data(), descriptors.size(), 10);
    }
    last_ = clock_.now();
  }

  std::vector<Finding> findings(const std::string& file) const {
    if (framesHeard() == 0) {
      return {{Health::kWrong, kWhat, before_.empty() ? "no frame within 3 s" : before_.back(),
               "roundabout mocap watch " + file + "   # goes on trying"}};
    }
    const double span_s = std::max(core::toSeconds(last_ - first_), 0.01);
    std::vector<Finding> findings = {
        {Health::kWell, kWhat,
         fmt::format("{}: {:.0f} frames a second", node_.source().status().server,
                     static_cast<double>(framesHeard()) / span_s),
         ""}};
    if (node_.setUpChecked()) {
      judgeBodies(findings);
    } else if (node_.estimator().counters().recorded > 0) {
      findings.push_back({Health::kWrong, kWhat,
                          "the system plays a recording back (Motive: Edit mode)",
                          "go to Live mode there"});
    } else {
      findings.push_back({Health::kWrong, kWhat, "its frames do not go on", ""});
    }
    return findings;
  }

 private:
  static std::unique_ptr<mocap_bridge::Source> listening(const config::Experiment& experiment,
                                                         const mocap_bridge::LocalClock& clock) {
    auto source = mocap_bridge::makeSource(experiment);
    source->setArrivalClock([&clock] { return clock.now(); });
    return source;
  }

  std::int64_t framesHeard() const {
    const auto& counters = node_.estimator().counters();
    return counters.frames + counters.recorded;
  }

  void judgeBodies(std::vector<Finding>& findings) const {
    std::vector<std::string> wrong = set_up_;
    const auto& vehicles = node_.estimator().vehicles();
    for (std::size_t i = 0; i < vehicles.size(); ++i) {
      if (const auto& rival = vehicles[i].rival; rival && *rival > i) {
        wrong.push_back(fmt::format("{} and {} are mapped to one body, {} (mocap.bodies)",
                                    vehicles[i].name, vehicles[*rival].name, vehicles[i].body));
      } else if (const core::VehicleState& state = node_.estimator().states().vehicles[i];
                 !rival && state.last_seen != 0 && !state.tracked) {
        wrong.push_back(fmt::format("{}: body {} was seen and is not any more", vehicles[i].name,
                                    vehicles[i].body));
      }
    }
    for (const std::string& one : wrong) {
      findings.push_back({Health::kWrong, "bodies", one, ""});
    }
    if (wrong.empty()) {
      findings.push_back({Health::kWell, "bodies", "every vehicle's is streamed and believed", ""});
    }
  }

  mocap_bridge::LocalClock clock_;
  bus::MemoryBus bus_;
  mocap_bridge::BridgeNode node_;
  std::vector<std::string> before_;  // what was said before the set-up was looked at
  std::vector<std::string> set_up_;
  core::Utime first_ = 0;
  core::Utime last_ = 0;
};

}  // namespace

std::vector<Finding> examineMocap(const config::Experiment& experiment) {
  if (experiment.source == "sim" || experiment.source == "replay") {
    return {{Health::kWell, kWhat, "none: source is " + experiment.source, ""}};
  }
  try {
    Trial trial(experiment);
    trial.run();
    return trial.findings(experiment.file);
  } catch (const core::StartupError& error) {
    const bool of_file = std::string_view(error.what()).starts_with(experiment.file);
    return {
        {Health::kWrong, kWhat, error.what(), of_file ? "correct it in " + experiment.file : ""}};
  }
}

}  // namespace roundabout::cli
