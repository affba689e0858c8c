#include "logs/frame_choice.h"

#include <algorithm>

namespace roundabout::logs {

void FrameChooser::see(std::size_t event, core::Utime utime) {
  const core::FrameVerdict verdict = gate_.judge(utime);
  if (verdict == core::FrameVerdict::kRefused) {
    refused_.push_back({event, utime});
    return;
  }
  if (flights_.empty() || verdict == core::FrameVerdict::kNewEpoch) {
    flights_.emplace_back();
  }
  admit({event, utime});
}

void FrameChooser::admit(const Frame& frame) {
  // No more than the gate needs to believe a jump.
  constexpr std::size_t kMostBefore = 9;
  std::vector<Frame>& flight = flights_.back();
  const core::Utime before = flight.empty() ? 0 : flight.back().utime;
  std::vector<Frame> run{frame};
  while (!refused_.empty() && run.size() <= kMostBefore && refused_.back().utime > before &&
         refused_.back().utime < run.back().utime) {
    run.push_back(refused_.back());
    refused_.pop_back();
  }
  flight.insert(flight.end(), run.rbegin(), run.rend());
  refused_.clear();
}

FrameChoice FrameChooser::longest(std::size_t num_events) const {
  FrameChoice choice;
  choice.end = num_events;
  const auto flight =
      std::max_element(flights_.begin(), flights_.end(),
                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (flight == flights_.end()) {
    return choice;
  }
  for (const Frame& frame : *flight) {
    choice.events.push_back(frame.event);
  }
  choice.begin = flight == flights_.begin() ? 0 : flight->front().event;
  choice.end = flight + 1 == flights_.end() ? num_events : (flight + 1)->front().event;
  return choice;
}

}  // namespace roundabout::logs
