// mocap_accuracy OUT: measures the estimator on flights whose truth is known and draws OUT.svg and
// OUT.png; prints the table of docs/mocap.md.

#include <cstdio>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "common/plot/gnuplot_script.h"
#include "mocap_bridge/estimation/state_estimator.h"
#include "tests/mocap_bridge/estimation/flown_path.h"

namespace {

using namespace roundabout;

constexpr double kRate_hz = 200.0;
constexpr double kWarmUp_s = 1.0;
constexpr double kDuration_s = 60.0;

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

struct Errors {
  double velocity_rms_mps = 0.0;
  double velocity_worst_mps = 0.0;
  double difference_rms_mps = 0.0;  // of plain differences of positions
  double position_worst_m = 0.0;
  double attitude_rms_rad = 0.0;
  double rate_rms_radps = 0.0;
  std::vector<std::string> rows;
};

Errors measure(const Condition& condition) {
  config::Experiment experiment;
  experiment.vehicles.emplace_back().name = "hex1";
  experiment.mocap.filter.position_noise_m = std::max(condition.position_noise_m, 5e-5);
  experiment.mocap.filter.orientation_noise_rad = std::max(condition.orientation_noise_rad, 5e-4);
  mocap_bridge::StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras;
  cameras.position_noise_m = condition.position_noise_m;
  cameras.orientation_noise_rad = condition.orientation_noise_rad;
  const test::FlownPath path;
  Errors errors;
  double count = 0.0;
  Eigen::Vector3d last_position = Eigen::Vector3d::Zero();
  for (int k = 0; k < static_cast<int>(kDuration_s * kRate_hz); ++k) {
    const double time_s = k / kRate_hz;
    const auto truth = path.at(time_s);
    mocap_bridge::SourceFrame frame;
    frame.number = k;
    frame.exposure_utime = 1'700'000'000'000'000 + core::toUtime(time_s);
    frame.bodies = {cameras.see(truth, "hex1")};
    const double in_period_s = std::fmod(time_s, 1.0 / std::max(condition.dropouts_per_s, 1e-9));
    frame.bodies[0].tracked = condition.dropouts_per_s == 0.0 || in_period_s >= condition.dropout_s;
    const Eigen::Vector3d difference_mps = (frame.bodies[0].position_m - last_position) * kRate_hz;
    last_position = frame.bodies[0].position_m;
    estimator.update(frame);
    const core::VehicleState& state = estimator.states().vehicles[0];
    if (time_s < kWarmUp_s || !(state.tracked || state.predicted)) {
      continue;
    }
    count += 1.0;
    const double velocity_mps = (state.velocity_world_mps - truth.velocity_mps).norm();
    errors.velocity_rms_mps += velocity_mps * velocity_mps;
    errors.velocity_worst_mps = std::max(errors.velocity_worst_mps, velocity_mps);
    errors.difference_rms_mps += (difference_mps - truth.velocity_mps).squaredNorm();
    errors.position_worst_m =
        std::max(errors.position_worst_m, (state.position_world_m - truth.position_m).norm());
    const double angle_rad = state.orientation.angularDistance(truth.orientation);
    errors.attitude_rms_rad += angle_rad * angle_rad;
    errors.rate_rms_radps +=
        (state.angular_velocity_body_radps - truth.rate_body_radps).squaredNorm();
    if (time_s < kWarmUp_s + 5.0) {
      errors.rows.push_back(
          fmt::format("{:.3f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}", time_s - kWarmUp_s,
                      truth.velocity_mps.x(), state.velocity_world_mps.x(), difference_mps.x(),
                      truth.rate_body_radps.y(), state.angular_velocity_body_radps.y()));
    }
  }
  for (double* sum : {&errors.velocity_rms_mps, &errors.difference_rms_mps,
                      &errors.attitude_rms_rad, &errors.rate_rms_radps}) {
    *sum = std::sqrt(*sum / count);
  }
  return errors;
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

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: mocap_accuracy OUT\n", stderr);
    return 2;
  }
  fmt::print(
      "| measurement noise, per axis | velocity RMS | worst | of differences, RMS | position, "
      "worst | "
      "attitude RMS | rate RMS |\n|---|---|---|---|---|---|---|\n");
  try {
    for (const Condition& condition : kConditions) {
      const Errors errors = measure(condition);
      fmt::print("| {} | {:.4f} m/s | {:.3f} | {:.3f} | {:.2f} mm | {:.4f} rad | {:.3f} rad/s |\n",
                 condition.name, errors.velocity_rms_mps, errors.velocity_worst_mps,
                 errors.difference_rms_mps, 1000.0 * errors.position_worst_m,
                 errors.attitude_rms_rad, errors.rate_rms_radps);
      if (&condition == &kConditions[2]) {
        draw(errors, argv[1]);
      }
    }
  } catch (const core::StartupError& error) {
    std::fprintf(stderr, "mocap_accuracy: %s\n", error.what());
    return 2;
  }
  return 0;
}
