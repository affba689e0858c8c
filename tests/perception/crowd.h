#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "common/core/random.h"
#include "perception/evaluation/clear_mot.h"
#include "perception/scan/scan_points.h"
#include "sim/sensors/lidar.h"

namespace roundabout::test {

/// People on two legs around a robot, and what its lidar sees of them.
struct CrowdSettings {
  int people = 6;
  int standing = 3;
  double reach_m = 6.0;    ///< of the people's way points, from the origin
  double closest_m = 0.7;  ///< people keep this apart, middle to middle
  double noise_m = 0.02;
  double missed_share = 0.0;
  int beams = 1080;
  double field_of_view_rad = 1.5 * std::numbers::pi;
  double range_m = 10.0;
  double robot_speed_mps = 0.0;  ///< round a circle of 1 m
  bool walls = false;            ///< of a room with 7 m to each side
  std::uint64_t seed = 1;
};

class Crowd {
 public:
  explicit Crowd(const CrowdSettings& settings)
      : settings_(settings), random_(settings.seed, "crowd"), noise_(settings.seed, "noise") {
    config::Lidar lidar;
    lidar.beams = settings.beams;
    lidar.field_of_view_rad = settings.field_of_view_rad;
    lidar.max_range_m = settings.range_m;
    lidar.noise_m = settings.noise_m;
    lidar_ = std::make_unique<sim::Lidar>(lidar);
    for (int i = 0; i < settings.people; ++i) {
      Person person;
      person.position_m = freePlace();
      person.target_m = freePlace();
      person.speed_mps = i < settings.standing ? 0.0 : random_.uniform(0.6, 1.4);
      person.heading_rad = random_.uniform(-3.1, 3.1);
      people_.push_back(person);
    }
  }

  void step(double step_s) {
    time_s_ += step_s;
    for (std::size_t i = 0; i < people_.size(); ++i) {
      move(i, step_s);
    }
  }

  perception::PlanarPose robot() const {
    const double angle_rad = settings_.robot_speed_mps * time_s_;
    return {settings_.robot_speed_mps == 0.0
                ? Eigen::Vector2d::Zero()
                : Eigen::Vector2d(std::sin(angle_rad), 1.0 - std::cos(angle_rad)),
            angle_rad};
  }

  core::LaserScan scan() {
    std::vector<sim::Disc> legs;
    for (const Person& person : people_) {
      // Legs swing against each other; a step is 0.7 m at 1.2 m/s.
      const Eigen::Vector2d ahead(std::cos(person.heading_rad), std::sin(person.heading_rad));
      const Eigen::Vector2d aside(-ahead.y(), ahead.x());
      const double swing_m = std::min(0.25, 0.2 * person.actual_mps) * std::sin(person.phase_rad);
      legs.push_back({person.position_m + 0.1 * aside + swing_m * ahead, 0.06});
      legs.push_back({person.position_m - 0.1 * aside - swing_m * ahead, 0.06});
    }
    const Eigen::AlignedBox2d room(Eigen::Vector2d(-7.0, -7.0), Eigen::Vector2d(7.0, 7.0));
    const auto seen = lidar_->sweep(robot().position_m, robot().heading_rad,
                                    {legs, {}, settings_.walls ? &room : nullptr}, &noise_);
    core::LaserScan scan{core::toUtime(1.0 + time_s_),
                         seen.first_angle_rad,
                         seen.angle_step_rad,
                         {seen.ranges_m.begin(), seen.ranges_m.end()}};
    for (float& range_m : scan.ranges_m) {
      if (noise_.chance(settings_.missed_share)) {
        range_m = static_cast<float>(settings_.range_m);
      }
    }
    return scan;
  }

  std::vector<perception::Sighting> truth() const {
    std::vector<perception::Sighting> truth;
    for (std::size_t i = 0; i < people_.size(); ++i) {
      truth.push_back(
          {static_cast<std::int32_t>(i), people_[i].position_m, people_[i].velocity_mps});
    }
    return truth;
  }

  /// Those within reach and in view.
  std::vector<perception::Sighting> visible() const {
    std::vector<perception::Sighting> seen = truth();
    std::erase_if(seen, [this](const perception::Sighting& somebody) {
      return !inView(somebody.position_m);
    });
    return seen;
  }

  /// False for a track of somebody whom visible() leaves out.
  bool isJudged(const Eigen::Vector2d& position_m) const {
    return inView(position_m) &&
           std::none_of(people_.begin(), people_.end(), [&](const Person& person) {
             return !inView(person.position_m) && (person.position_m - position_m).norm() < 0.5;
           });
  }

 private:
  struct Person {
    Eigen::Vector2d position_m;
    Eigen::Vector2d target_m;
    Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
    double speed_mps = 0.0;
    double actual_mps = 0.0;
    double heading_rad = 0.0;
    double phase_rad = 0.0;
  };

  bool inView(const Eigen::Vector2d& position_m) const {
    const Eigen::Vector2d ray_m = position_m - robot().position_m;
    const double bearing = std::remainder(std::atan2(ray_m.y(), ray_m.x()) - robot().heading_rad,
                                          2.0 * std::numbers::pi);
    return std::abs(bearing) < settings_.field_of_view_rad / 2.0 - 0.1 &&
           ray_m.norm() < settings_.reach_m;
  }

  Eigen::Vector2d freePlace() {
    while (true) {
      const Eigen::Vector2d place(random_.uniform(-0.7, 0.7) * settings_.reach_m,
                                  random_.uniform(-0.7, 0.7) * settings_.reach_m);
      const bool free = std::none_of(people_.begin(), people_.end(), [&](const Person& person) {
        return (person.position_m - place).norm() < 1.5 * settings_.closest_m;
      });
      if (free && place.norm() > 1.8 && place.norm() < settings_.reach_m) {
        return place;
      }
    }
  }

  void move(std::size_t i, double step_s) {
    Person& person = people_[i];
    if ((person.target_m - person.position_m).norm() < 0.3) {
      person.target_m = freePlace();
    }
    // Straight on, pushed off by who is near; a person's velocity follows within 0.3 s.
    Eigen::Vector2d wanted = person.speed_mps * (person.target_m - person.position_m).normalized();
    const auto avoid = [&](const Eigen::Vector2d& place, double distance_m) {
      const Eigen::Vector2d away = person.position_m - place;
      if (away.norm() < 1.5 * distance_m && person.speed_mps > 0.0) {
        const Eigen::Vector2d right(away.y(), -away.x());
        wanted += 2.0 * (1.5 * distance_m - away.norm()) / distance_m *
                  (away.normalized() + 0.5 * right.normalized());
      }
    };
    for (std::size_t j = 0; j < people_.size(); ++j) {
      if (j != i) {
        avoid(people_[j].position_m, settings_.closest_m);
      }
    }
    avoid(robot().position_m, 1.2);
    if (wanted.norm() > 1.5) {
      wanted *= 1.5 / wanted.norm();
    }
    person.velocity_mps += (wanted - person.velocity_mps) * std::min(1.0, step_s / 0.3);
    person.position_m += step_s * person.velocity_mps;
    person.actual_mps = person.velocity_mps.norm();
    if (person.actual_mps > 0.1) {
      person.heading_rad = std::atan2(person.velocity_mps.y(), person.velocity_mps.x());
    }
    // A step of each leg in a period.
    person.phase_rad += 2.0 * std::numbers::pi * (0.4 + 0.45 * person.actual_mps) * step_s *
                        (person.actual_mps > 0.05 ? 1.0 : 0.0);
  }

  CrowdSettings settings_;
  core::RandomStream random_;
  core::RandomStream noise_;
  std::unique_ptr<sim::Lidar> lidar_;
  std::vector<Person> people_;
  double time_s_ = 0.0;
};

}  // namespace roundabout::test
