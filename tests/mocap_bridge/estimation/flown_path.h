#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include "common/core/random.h"
#include "common/core/rotation.h"
#include "common/core/time.h"
#include "mocap_bridge/sources/source_frame.h"

namespace roundabout::test {

/// A flight whose truth is known at every time: sums of sines, up to 2 m/s and 5 m/s², with a tilt
/// that follows the acceleration as a multirotor's does, and a turning nose. Independent of the
/// project's simulator.
class FlownPath {
 public:
  struct Truth {
    Eigen::Vector3d position_m;
    Eigen::Vector3d velocity_mps;
    Eigen::Vector3d acceleration_mps2;
    Eigen::Quaterniond orientation;
    Eigen::Vector3d rate_body_radps;
  };

  explicit FlownPath(int number = 0) : centre_m_(2.5 * number, 0.0, 1.5), phase_(0.7 * number) {}

  Truth at(double time_s) const {
    Truth truth;
    truth.position_m = centre_m_;
    truth.velocity_mps.setZero();
    truth.acceleration_mps2.setZero();
    for (const Wave& wave : kWaves) {
      const double angle = wave.rate_radps * time_s + wave.phase + phase_;
      const Eigen::Vector3d size = wave.amplitude_m;
      truth.position_m += size * std::sin(angle);
      truth.velocity_mps += size * (wave.rate_radps * std::cos(angle));
      truth.acceleration_mps2 -= size * (wave.rate_radps * wave.rate_radps * std::sin(angle));
    }
    truth.orientation = attitudeAt(time_s, truth.acceleration_mps2);
    constexpr double kStep_s = 1e-5;
    const Eigen::Quaterniond later = attitudeAt(time_s + kStep_s, accelerationAt(time_s + kStep_s));
    truth.rate_body_radps = core::toRotationVector(truth.orientation.conjugate() * later) / kStep_s;
    return truth;
  }

 private:
  struct Wave {
    Eigen::Vector3d amplitude_m;
    double rate_radps;
    double phase;
  };
  inline static const Wave kWaves[] = {
      {{0.55, 0.0, 0.0}, 2.4, 0.0}, {{0.0, 0.5, 0.1}, 2.0, 1.0}, {{0.04, 0.03, 0.01}, 5.5, 0.4}};

  Eigen::Vector3d accelerationAt(double time_s) const {
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
    for (const Wave& wave : kWaves) {
      const double angle = wave.rate_radps * time_s + wave.phase + phase_;
      acceleration -= wave.amplitude_m * (wave.rate_radps * wave.rate_radps * std::sin(angle));
    }
    return acceleration;
  }
  static Eigen::Quaterniond attitudeAt(double time_s, const Eigen::Vector3d& acceleration_mps2) {
    const Eigen::Vector3d thrust = acceleration_mps2 + Eigen::Vector3d(0.0, 0.0, 9.81);
    // Half way from up to the thrust, as a quaternion.
    const double up = thrust.z() / thrust.norm();
    const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ().cross(thrust) / thrust.norm();
    Eigen::Quaterniond tilt(1.0 + up, axis.x(), axis.y(), axis.z());
    tilt.normalize();
    return tilt * Eigen::AngleAxisd(0.8 * std::sin(0.6 * time_s), Eigen::Vector3d::UnitZ());
  }

  Eigen::Vector3d centre_m_;
  double phase_;
};

/// What cameras make of it.
struct Cameras {
  double position_noise_m = 0.0002;
  double orientation_noise_rad = 0.002;
  core::RandomStream random{1, "cameras"};

  mocap_bridge::BodyPose see(const FlownPath::Truth& truth, const std::string& name) {
    mocap_bridge::BodyPose pose;
    pose.name = name;
    pose.position_m = truth.position_m + random.normal3(position_noise_m);
    pose.orientation =
        truth.orientation * core::fromRotationVector(random.normal3(orientation_noise_rad));
    pose.tracked = true;
    return pose;
  }
};

}  // namespace roundabout::test
