#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "perception/agent_finder.h"
#include "perception/clustering/table.h"
#include "tests/perception/crowd.h"

namespace roundabout::perception {

/// Follows a crowd; `together` gathers several runs.
inline ClearMot::Result follow(const test::CrowdSettings& settings, const std::string& clusterer,
                               double duration_s = 30.0, ClearMot* together = nullptr) {
  test::Crowd crowd(settings);
  config::Perception perception;
  perception.max_range_m = settings.range_m;
  AgentFinder finder(perception, makeClusterer(clusterer, "test"));
  ClearMot judge(0.5);
  constexpr double kPeriod_s = 0.025;
  for (double time_s = 0.0; time_s < duration_s; time_s += kPeriod_s) {
    crowd.step(kPeriod_s);
    finder.update(crowd.scan(), crowd.robot(), crowd.robot(), nullptr);
    std::vector<Sighting> tracked;
    for (const core::AgentTrack& track : finder.tracker().tracks()) {
      if (crowd.isJudged(track.position_world_m)) {
        tracked.push_back({track.id, track.position_world_m, track.velocity_world_mps});
      }
    }
    if (time_s > 1.0) {
      judge.add(crowd.visible(), tracked);
      if (together != nullptr) {
        // Other people in every crowd.
        std::vector<Sighting> people = crowd.visible();
        for (Sighting& somebody : people) {
          somebody.id += 1000 * static_cast<std::int32_t>(settings.seed);
        }
        together->add(people, tracked);
      }
    }
  }
  return judge.result();
}

inline void say(const char* what, const ClearMot::Result& result) {
  std::printf(
      "%-34s MOTA %.3f MOTP %.3f m, switches %lld, missed %.3f, false %.3f, velocity %.3f m/s\n",
      what, result.accuracy, result.precision_m, static_cast<long long>(result.switches),
      static_cast<double>(result.misses) / static_cast<double>(result.truths),
      static_cast<double>(result.false_tracks) / static_cast<double>(result.truths),
      result.velocity_rms_mps);
}

}  // namespace roundabout::perception
