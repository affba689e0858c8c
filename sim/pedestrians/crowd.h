#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "common/core/random.h"
#include "common/core/tick_timer.h"
#include "sim/dynamics/dynamics.h"
#include "sim/pedestrians/pedestrian.h"
#include "sim/pedestrians/recording.h"
#include "sim/pedestrians/steering.h"

namespace roundabout::sim {

/// Every pedestrian of an experiment: those who walk by a policy, numbered from 1, then the
/// recorded ones, whose ids are kRecordedIds more than the recording's. Nobody comes out of nothing
/// within pedestrians.clear_of_vehicles_m of a vehicle: a recorded person whose track would begin
/// there is left out until it is farther away. Random numbers come from the stream "pedestrians" of
/// the seed.
class Crowd {
 public:
  static constexpr std::int32_t kRecordedIds = 10'000;

  /// Throws core::StartupError: no room in pedestrians.area, or as RecordedPeople does.
  /// starts: of the vehicles.
  Crowd(const config::Experiment& experiment, std::span<const BodyState> starts,
        const SteeringFactory& make_steering, core::Utime first_utime);

  /// Advances to `now`, `step_s` after the call before.
  void step(core::Utime now, double step_s, std::span<const BodyState> bodies);

  std::span<const Pedestrian> people() const { return people_; }

 private:
  struct Walker {
    Pedestrian person;
    std::unique_ptr<Steering> steering;
    Eigen::Vector2d goal_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d wanted_mps = Eigen::Vector2d::Zero();
    double preferred_speed_mps = 1.0;
    double cooperation = 1.0;
    bool stands = false;
  };

  void place(std::span<const BodyState> starts, const SteeringFactory& make_steering);
  std::optional<Eigen::Vector2d> freePlace(std::span<const BodyState> starts);
  Eigen::Vector2d place();
  bool isClear(const Eigen::Vector2d& place_m) const;
  void chooseGoal(Walker& walker);
  void decide(std::span<const BodyState> bodies);
  void exchangeRoles();
  void collect(double seconds, std::span<const BodyState> bodies);
  bool besideAVehicle(const Eigen::Vector2d& place_m, std::span<const BodyState> bodies) const;

  const config::Pedestrians settings_;
  const std::string file_;
  std::vector<core::Polygon> obstacles_;
  std::vector<double> vehicle_radii_m_;
  core::RandomStream random_;
  core::TickTimer timer_;
  core::Utime first_utime_;
  std::vector<Walker> walkers_;
  std::optional<RecordedPeople> recorded_;
  std::vector<Pedestrian> recorded_now_;
  std::vector<Pedestrian> people_;
  std::vector<core::OtherAgent> others_;
};

}  // namespace roundabout::sim
