#include "mocap_bridge/tools/body_table.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::mocap_bridge {

namespace {

std::string vehicleOf(const std::string& body, const StateEstimator& estimator) {
  for (const StateEstimator::Vehicle& vehicle : estimator.vehicles()) {
    if (vehicle.body == body) {
      return fmt::format("{} ({})", vehicle.name, mocap_bridge::nameOf(vehicle.last));
    }
  }
  return "-";
}

}  // namespace

void BodyTable::add(const SourceFrame& frame) {
  ++frames_;
  latencies_ms_.push_back(1000.0 * core::toSeconds(frame.received_utime - frame.exposure_utime));
  for (const BodyPose& body : frame.bodies) {
    Row& row = rows_[nameOf(body)];
    ++row.frames;
    row.gaps += row.tracked && !body.tracked ? 1 : 0;
    row.tracked = body.tracked;
    row.residual_m = body.residual_m;
    if (body.tracked) {
      row.last_tracked = frame.exposure_utime;
      row.position_m = body.position_m;
    }
  }
}

std::string BodyTable::text(core::Utime now, const StateEstimator& estimator) {
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
  for (auto& [name, row] : rows_) {
    const std::string age =
        row.last_tracked == 0
            ? "never"
            : fmt::format("{:.1f}", 1000.0 * core::toSeconds(now - row.last_tracked));
    const std::string residual =
        std::isfinite(row.residual_m) ? fmt::format("{:.2f}", 1000.0 * row.residual_m) : "-";
    text += fmt::format("{:<20} {:>8.1f} {:>9} {:>11} {:>6}  {:<26} {}\n", name,
                        static_cast<double>(row.frames) / passed_s, age, residual, row.gaps,
                        fmt::format("({:.3f}, {:.3f}, {:.3f})", row.position_m.x(),
                                    row.position_m.y(), row.position_m.z()),
                        vehicleOf(name, estimator));
    row.frames = 0;
  }
  for (const StateEstimator::Vehicle& vehicle : estimator.vehicles()) {
    if (!rows_.contains(vehicle.body)) {
      text += fmt::format("{:<20} not streamed; {} waits for it\n", vehicle.body, vehicle.name);
    }
  }
  last_text_ = now;
  frames_ = 0;
  return text;
}

}  // namespace roundabout::mocap_bridge
