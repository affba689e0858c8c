#include "mocap_bridge/tools/body_table.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::mocap_bridge {

namespace {

// Not in the frames for so long: said.
constexpr core::Utime kGone = core::kMicrosPerSecond;
// And for so long: forgotten.
constexpr core::Utime kForget = 10 * core::kMicrosPerSecond;

std::string since(core::Utime then, core::Utime now) {
  return then == 0 ? "never" : fmt::format("{:.1f}", 1000.0 * core::toSeconds(now - then));
}

std::string vehicleOf(std::int64_t id, const std::string& name, const StateEstimator& estimator) {
  for (const StateEstimator::Vehicle& vehicle : estimator.vehicles()) {
    if (!config::matches(vehicle.key, name, id)) {
      continue;
    }
    if (vehicle.rival) {
      return fmt::format("{} and {}: neither is believed", vehicle.name,
                         estimator.vehicles()[*vehicle.rival].name);
    }
    return fmt::format("{} ({})", vehicle.name, mocap_bridge::nameOf(vehicle.last));
  }
  return "-";
}

}  // namespace

void BodyTable::add(const SourceFrame& frame) {
  ++frames_;
  ++all_frames_;
  latencies_ms_.push_back(1000.0 * core::toSeconds(frame.received_utime - frame.exposure_utime));
  for (const BodyPose& body : frame.bodies) {
    Row& row = rows_[{body.id, body.id < 0 ? body.name : ""}];
    row.name = body.name;
    ++row.frames;
    row.in_frame = all_frames_;
    row.last_streamed = frame.exposure_utime;
    row.gaps += row.tracked && !body.tracked ? 1 : 0;
    row.tracked = body.tracked;
    row.residual_m = body.residual_m;
    if (body.tracked) {
      row.last_tracked = frame.exposure_utime;
      row.position_m = body.position_m;
    }
  }
  for (auto& [key, row] : rows_) {
    if (row.in_frame != all_frames_ && row.tracked) {
      ++row.gaps;
      row.tracked = false;
    }
  }
}

std::string BodyTable::rowText(const Key& key, const Row& row, core::Utime now, double passed_s,
                               const StateEstimator& estimator) const {
  const std::string residual =
      std::isfinite(row.residual_m) ? fmt::format("{:.2f}", 1000.0 * row.residual_m) : "-";
  const std::string rate = now - row.last_streamed > kGone
                               ? "gone"
                               : fmt::format("{:.1f}", static_cast<double>(row.frames) / passed_s);
  return fmt::format("{:<20} {:>8} {:>9} {:>11} {:>6}  {:<26} {}\n",
                     config::bodyText(row.name, key.first), rate, since(row.last_tracked, now),
                     residual, row.gaps,
                     fmt::format("({:.3f}, {:.3f}, {:.3f})", row.position_m.x(), row.position_m.y(),
                                 row.position_m.z()),
                     vehicleOf(key.first, row.name, estimator));
}

std::string BodyTable::text(core::Utime now, const StateEstimator& estimator) {
  std::erase_if(rows_, [&](const auto& row) { return now - row.second.last_streamed > kForget; });
  const double passed_s = core::toSeconds(now - last_text_);
  std::string text = fmt::format("{:.1f} frames a second", static_cast<double>(frames_) / passed_s);
  if (!latencies_ms_.empty()) {
    std::sort(latencies_ms_.begin(), latencies_ms_.end());
    text += fmt::format("; exposure to arrival: median {:.2f} ms, longest {:.2f} ms",
                        latencies_ms_[latencies_ms_.size() / 2], latencies_ms_.back());
    latencies_ms_.clear();
  }
  text += '\n';
  text += fmt::format("{:<20} {:>8} {:>9} {:>11} {:>6}  {:<26} {}\n", "body", "rate Hz", "age ms",
                      "residual mm", "gaps", "position", "vehicle");
  for (auto& [key, row] : rows_) {
    text += rowText(key, row, now, passed_s, estimator);
    row.frames = 0;
  }
  for (const StateEstimator::Vehicle& vehicle : estimator.vehicles()) {
    const bool streamed = std::any_of(rows_.begin(), rows_.end(), [&](const auto& row) {
      return config::matches(vehicle.key, row.second.name, row.first.first);
    });
    if (!streamed) {
      text += fmt::format("{:<20} not streamed; {} waits for it\n", vehicle.body, vehicle.name);
    }
  }
  last_text_ = now;
  frames_ = 0;
  return text;
}

}  // namespace roundabout::mocap_bridge
