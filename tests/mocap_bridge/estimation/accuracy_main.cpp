// mocap_accuracy OUT: measures the estimator on flights whose truth is known and draws OUT.svg and
// OUT.png; prints the table of docs/mocap.md.

#include <algorithm>
#include <cstdio>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "common/plot/gnuplot_script.h"
#include "mocap_bridge/estimation/state_estimator.h"
#include "mocap_bridge/sources/exposure_clock.h"
#include "tests/mocap_bridge/estimation/flown_path.h"

namespace {

using namespace roundabout;

constexpr double kRate_hz = 200.0;
constexpr double kWarmUp_s = 1.0;
constexpr double kDuration_s = 60.0;
constexpr core::Utime kEpoch = 1'700'000'000'000'000;

struct Condition {
  const char* name;
  double position_noise_m;
  double orientation_noise_rad;
  double dropouts_per_s;
  double dropout_s;
};

constexpr Condition kConditions[] = {
    {"0.005 mm, 0.0002 rad (a static body in the recorded session)", 5e-6, 2e-4, 0.0, 0.0},
    {"0.1 mm, 0.001 rad", 1e-4, 1e-3, 0.0, 0.0},
    {"0.2 mm, 0.002 rad", 2e-4, 2e-3, 0.0, 0.0},
    {"0.5 mm, 0.005 rad", 5e-4, 5e-3, 0.0, 0.0},
    {"0.2 mm, 0.002 rad, one dropout a second of 25 ms", 2e-4, 2e-3, 1.0, 0.025},
    {"0.2 mm, 0.002 rad, one dropout a second of 80 ms", 2e-4, 2e-3, 1.0, 0.080},
};

/// Root mean squares and worsts of what is published against the truth.
class Errors {
 public:
  void add(const core::VehicleState& state, const test::FlownPath::Truth& truth) {
    count_ += 1.0;
    const double velocity_mps = (state.velocity_world_mps - truth.velocity_mps).norm();
    velocity_ += velocity_mps * velocity_mps;
    velocity_worst_mps = std::max(velocity_worst_mps, velocity_mps);
    position_worst_m =
        std::max(position_worst_m, (state.position_world_m - truth.position_m).norm());
    const double angle_rad = state.orientation.angularDistance(truth.orientation);
    attitude_ += angle_rad * angle_rad;
    rate_ += (state.angular_velocity_body_radps - truth.rate_body_radps).squaredNorm();
  }
  void addDifference(const Eigen::Vector3d& error_mps) { difference_ += error_mps.squaredNorm(); }

  double velocityRms() const { return rms(velocity_); }
  double differenceRms() const { return rms(difference_); }  ///< of plain differences of positions
  double attitudeRms() const { return rms(attitude_); }
  double rateRms() const { return rms(rate_); }
  double velocity_worst_mps = 0.0;
  double position_worst_m = 0.0;
  std::vector<std::string> rows;

 private:
  double rms(double sum) const { return std::sqrt(sum / count_); }

  double count_ = 0.0;
  double velocity_ = 0.0;
  double difference_ = 0.0;
  double attitude_ = 0.0;
  double rate_ = 0.0;
};

config::Experiment experimentFor(const Condition& condition) {
  config::Experiment experiment;
  experiment.vehicles.emplace_back().name = "hex1";
  experiment.mocap.filter.position_noise_m = std::max(condition.position_noise_m, 5e-5);
  experiment.mocap.filter.orientation_noise_rad = std::max(condition.orientation_noise_rad, 5e-4);
  return experiment;
}

test::Cameras camerasFor(const Condition& condition) {
  test::Cameras cameras;
  cameras.position_noise_m = condition.position_noise_m;
  cameras.orientation_noise_rad = condition.orientation_noise_rad;
  return cameras;
}

bool dropped(const Condition& condition, double time_s) {
  const double in_period_s = std::fmod(time_s, 1.0 / std::max(condition.dropouts_per_s, 1e-9));
  return condition.dropouts_per_s > 0.0 && in_period_s < condition.dropout_s;
}

Errors measure(const Condition& condition) {
  const config::Experiment experiment = experimentFor(condition);
  mocap_bridge::StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras = camerasFor(condition);
  const test::FlownPath path;
  Errors errors;
  Eigen::Vector3d last_position = Eigen::Vector3d::Zero();
  for (int k = 0; k < static_cast<int>(kDuration_s * kRate_hz); ++k) {
    const double time_s = k / kRate_hz;
    const auto truth = path.at(time_s);
    mocap_bridge::SourceFrame frame;
    frame.number = k;
    frame.exposure_utime = kEpoch + core::toUtime(time_s);
    frame.bodies = {cameras.see(truth, "hex1")};
    frame.bodies[0].tracked = !dropped(condition, time_s);
    const Eigen::Vector3d difference_mps = (frame.bodies[0].position_m - last_position) * kRate_hz;
    last_position = frame.bodies[0].position_m;
    estimator.update(frame);
    const core::VehicleState& state = estimator.states().vehicles[0];
    if (time_s < kWarmUp_s || !(state.tracked || state.predicted)) {
      continue;
    }
    errors.add(state, truth);
    errors.addDifference(difference_mps - truth.velocity_mps);
    if (time_s < kWarmUp_s + 5.0) {
      errors.rows.push_back(
          fmt::format("{:.3f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}", time_s - kWarmUp_s,
                      truth.velocity_mps.x(), state.velocity_world_mps.x(), difference_mps.x(),
                      truth.rate_body_radps.y(), state.angular_velocity_body_radps.y()));
    }
  }
  return errors;
}

/// What lies between cameras and bridge, as in the recorded session: exposure to sending 5.09 to
/// 5.89 ms; on the way 0.3 ms (median) to 5 ms; the other clock 40 ppm fast; echoes every 250 ms.
class Wire {
 public:
  explicit Wire(bool echoes) : echoes_(echoes), clock_(kLatency_s) {}

  struct Arrival {
    double at_s;                          // true time
    std::optional<core::Utime> exposure;  // as the bridge believes
  };

  Arrival carry(double exposed_s) {
    const double sent_s = exposed_s + random_.uniform(0.00509, 0.00589);
    arrived_s_ = std::max(arrived_s_, sent_s + 0.0001 + onTheWay());
    mocap_bridge::ExposureClock::Stamps stamps;
    stamps.sent_s = remote(sent_s);
    if (echoes_) {
      stamps.exposure_s = remote(exposed_s);
      answerEcho(arrived_s_);
    }
    return {arrived_s_, clock_.exposureOf(stamps, kEpoch + core::toUtime(arrived_s_))};
  }

 private:
  // Without exposure stamps, what the experiment file says of it: the shortest way, 5.4 + 0.1 ms.
  static constexpr double kLatency_s = 0.0055;

  static double remote(double true_s) { return 5000.0 + true_s * (1.0 + 40e-6); }
  // Median 0.3 ms.
  double onTheWay() {
    return std::min(-0.000433 * std::log(1.0 - random_.uniform(0.0, 1.0)), 0.005);
  }
  void answerEcho(double now_s) {
    if (now_s < next_echo_s_) {
      return;
    }
    next_echo_s_ = now_s + 0.25;
    const double there_s = 0.0003 + 0.5 * onTheWay();
    const double back_s = 0.0003 + 0.5 * onTheWay();
    const double middle_s = now_s - 0.5 * (there_s + back_s);
    clock_.addEcho(remote(now_s - back_s), kEpoch + core::toUtime(middle_s), there_s + back_s);
  }

  bool echoes_;
  mocap_bridge::ExposureClock clock_;
  core::RandomStream random_{2, "wire"};
  double arrived_s_ = 0.0;
  double next_echo_s_ = 0.0;
};

struct WireErrors {
  Errors errors;
  std::vector<double> stamps_ms;  // believed minus true exposure
};

/// What is published is held against the truth at its utime, on the local clock.
WireErrors measureBehindAWire(const Condition& condition, bool echoes, bool resampled) {
  constexpr double kSettled_s = 5.0;
  const core::Utime period = core::toUtime(1.0 / kRate_hz);
  const config::Experiment experiment = experimentFor(condition);
  mocap_bridge::StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras = camerasFor(condition);
  const test::FlownPath path;
  Wire wire(echoes);
  WireErrors result;
  const auto judge = [&](const core::StatesFrame& states) {
    const core::VehicleState& state = states.vehicles[0];
    const double at_s = core::toSeconds(states.utime - kEpoch);
    if (at_s >= kSettled_s && (state.tracked || state.predicted)) {
      result.errors.add(state, path.at(at_s));
    }
  };
  core::Utime tick = kEpoch;
  for (int k = 1; k < static_cast<int>(kDuration_s * kRate_hz); ++k) {
    const double time_s = k / kRate_hz;
    const Wire::Arrival arrival = wire.carry(time_s);
    const core::Utime arrived = kEpoch + core::toUtime(arrival.at_s);
    // Ticks until this frame came were predicted from the one before.
    for (; resampled && tick <= arrived; tick += period) {
      if (k > 1) {
        judge(estimator.statesAt(tick));
      }
    }
    if (!arrival.exposure) {
      continue;
    }
    mocap_bridge::SourceFrame frame;
    frame.number = k;
    frame.exposure_utime = *arrival.exposure;
    frame.bodies = {cameras.see(path.at(time_s), "hex1")};
    frame.bodies[0].tracked = !dropped(condition, time_s);
    estimator.update(frame);
    if (time_s >= kSettled_s) {
      result.stamps_ms.push_back(
          std::abs(1000.0 * (core::toSeconds(frame.exposure_utime - kEpoch) - time_s)));
    }
    if (!resampled) {
      judge(estimator.states());
    }
  }
  std::sort(result.stamps_ms.begin(), result.stamps_ms.end());
  return result;
}

void draw(const Errors& errors, const std::string& out) {
  for (const auto& [terminal, extension] :
       {std::pair{"svg size 1000,700 dynamic background 'white'", "svg"},
        std::pair{"pngcairo size 1000,700", "png"}}) {
    plot::GnuplotScript script;
    script.line("set terminal {}", terminal);
    script.line("set output {}", plot::gnuplotString(out + "." + extension));
    script.data("flight", errors.rows);
    script.line("set multiplot layout 2,1");
    script.line("set grid lt 1 lc rgb '#e8e8e8'");
    script.line("set xlabel 'time (s)'");
    script.line("set ylabel 'velocity x (m/s)'");
    script.line(
        "plot $flight u 1:4 w l lc rgb '#dddddd' t 'differences of measured positions', $flight u "
        "1:2 "
        "w l lw 3 lc rgb '#888888' t 'truth', $flight u 1:3 w l lc rgb '#1f77b4' t 'published'");
    script.line("set ylabel 'pitch rate (rad/s)'");
    script.line(
        "plot $flight u 1:5 w l lw 3 lc rgb '#888888' t 'truth', $flight u 1:6 w l lc rgb "
        "'#d62728' t "
        "'published'");
    script.line("unset multiplot");
    script.run();
  }
}

void printNoise(const std::string& out) {
  fmt::print(
      "| measurement noise, per axis | velocity RMS | worst | of differences, RMS | position, "
      "worst | attitude RMS | rate RMS |\n|---|---|---|---|---|---|---|\n");
  for (const Condition& condition : kConditions) {
    const Errors errors = measure(condition);
    fmt::print("| {} | {:.4f} m/s | {:.3f} | {:.3f} | {:.2f} mm | {:.4f} rad | {:.3f} rad/s |\n",
               condition.name, errors.velocityRms(), errors.velocity_worst_mps,
               errors.differenceRms(), 1000.0 * errors.position_worst_m, errors.attitudeRms(),
               errors.rateRms());
    if (&condition == &kConditions[2]) {
      draw(errors, out);
    }
  }
}

void printDelay() {
  struct Way {
    const char* name;
    bool echoes;
    bool resampled;
  };
  constexpr Way kWays[] = {
      {"NatNet: exposure stamps and echoes; at the camera's times", true, false},
      {"the same, resampled: predicted over the delay", true, true},
      {"stamps of sending only, no echoes; at the camera's times", false, false},
      {"the same, resampled", false, true}};
  const Condition& condition = kConditions[4];
  fmt::print(
      "\n{}, delay and jitter of the recorded session:\n\n| way | velocity RMS | worst | position, "
      "worst | attitude RMS | rate RMS | stamp, median | worst "
      "|\n|---|---|---|---|---|---|---|---|\n",
      condition.name);
  for (const Way& way : kWays) {
    const auto [errors, stamps_ms] = measureBehindAWire(condition, way.echoes, way.resampled);
    fmt::print(
        "| {} | {:.4f} m/s | {:.3f} | {:.2f} mm | {:.4f} rad | {:.3f} rad/s | {:.3f} ms | {:.3f} "
        "|\n",
        way.name, errors.velocityRms(), errors.velocity_worst_mps, 1000.0 * errors.position_worst_m,
        errors.attitudeRms(), errors.rateRms(), stamps_ms[stamps_ms.size() / 2], stamps_ms.back());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: mocap_accuracy OUT\n", stderr);
    return 2;
  }
  try {
    printNoise(argv[1]);
    printDelay();
  } catch (const core::StartupError& error) {
    std::fprintf(stderr, "mocap_accuracy: %s\n", error.what());
    return 2;
  }
  return 0;
}
