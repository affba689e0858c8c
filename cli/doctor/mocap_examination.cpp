#include "cli/doctor/mocap_examination.h"

#include <algorithm>
#include <memory>
#include <string>

#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/config/mapped_body.h"
#include "common/core/error.h"
#include "mocap_bridge/local_clock.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::cli {

namespace {

using mocap_bridge::BodyPose;

constexpr const char* kWhat = "motion capture";
// A session says after 2 s what it waits for.
constexpr core::Utime kPatience = 3 * core::kMicrosPerSecond;
constexpr core::Utime kEnough = core::kMicrosPerSecond / 2;

struct Frames final : mocap_bridge::PacketSink {
  void onFrame(const mocap_bridge::SourceFrame& frame) override {
    first = count == 0 ? frame.exposure_utime : first;
    last = frame.exposure_utime;
    recorded = recorded || frame.recorded;
    bodies = frame.bodies;
    ++count;
  }
  core::Utime span() const { return last - first; }

  std::vector<BodyPose> bodies;  // of the last frame
  int count = 0;
  core::Utime first = 0;
  core::Utime last = 0;
  bool recorded = false;
};

/// Bodies that vehicles wait for and that are not streamed.
std::vector<std::string> missingBodies(const config::Experiment& experiment,
                                       const std::vector<BodyPose>& bodies) {
  std::vector<std::string> missing;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    const config::BodyKey key = config::bodyKeyOf(experiment.mocap, vehicle.name);
    const auto is = [&](const BodyPose& body) {
      return key.name.empty() ? body.id == key.id : body.name == key.name;
    };
    if (std::none_of(bodies.begin(), bodies.end(), is)) {
      missing.push_back(text(key));
    }
  }
  return missing;
}

void judgeFrames(const config::Experiment& experiment, const Frames& frames,
                 const std::string& server, std::vector<Finding>& findings) {
  const double rate_hz = frames.span() > 0 ? (frames.count - 1) / core::toSeconds(frames.span())
                                           : static_cast<double>(frames.count);
  findings.push_back(
      {Health::kWell, kWhat, fmt::format("{}: {:.0f} frames a second", server, rate_hz), ""});
  if (frames.recorded) {
    findings.push_back({Health::kWrong, kWhat,
                        "the system plays a recording back (Motive: Edit mode)",
                        "go to Live mode there"});
  }
  std::vector<std::string> streamed;
  for (const BodyPose& body : frames.bodies) {
    streamed.push_back(nameOf(body));
  }
  const std::vector<std::string> missing = missingBodies(experiment, frames.bodies);
  if (missing.empty()) {
    findings.push_back({Health::kWell, "bodies", "every vehicle's is streamed", ""});
  } else {
    findings.push_back(
        {Health::kWrong, "bodies",
         fmt::format("not streamed: {}; streamed: {}", fmt::join(missing, ", "),
                     streamed.empty() ? "none" : fmt::format("{}", fmt::join(streamed, ", "))),
         "mocap.bodies says which body is which vehicle"});
  }
}

}  // namespace

std::vector<Finding> examineMocap(const config::Experiment& experiment) {
  std::vector<Finding> findings;
  if (experiment.source == "sim" || experiment.source == "replay") {
    return {{Health::kWell, kWhat, "none: source is " + experiment.source, ""}};
  }
  std::unique_ptr<mocap_bridge::Source> source;
  try {
    source = mocap_bridge::protocolNamed(experiment.source).make_session(experiment.mocap);
  } catch (const core::StartupError& error) {
    return {{Health::kWrong, kWhat, error.what(), "correct it in " + experiment.file}};
  }
  const mocap_bridge::LocalClock clock;
  source->setArrivalClock([&clock] { return clock.now(); });
  Frames frames;
  std::vector<std::string> notes;
  const core::Utime began = clock.now();
  while (clock.now() - began < kPatience && frames.span() < kEnough) {
    source->poll(clock.now(), frames);
    for (std::string& note : source->takeNotes()) {
      notes.push_back(std::move(note));
    }
    std::vector<pollfd> descriptors;
    source->addDescriptors(descriptors);
    poll(descriptors.data(), descriptors.size(), 10);
  }
  if (frames.count > 0) {
    judgeFrames(experiment, frames, source->status().server, findings);
  } else {
    findings.push_back({Health::kWrong, kWhat, notes.empty() ? "no frame within 3 s" : notes.back(),
                        "roundabout mocap watch " + experiment.file + "   # goes on trying"});
  }
  return findings;
}

}  // namespace roundabout::cli
