#pragma once

#include <optional>
#include <vector>

#include "planner/shield/brake_constraints.h"

namespace roundabout::planner::shield {

/// Gets out of the way of vehicles that are not shielded: from those, braking saves nobody. They
/// are taken to go on as they do, the ego as its dynamics allow.
class Evasion {
 public:
  explicit Evasion(const ShieldParameters& parameters) : parameters_(parameters) {}

  /// If the wanted command does not stay clear of them: the one that does and is near it, or comes
  /// least near to them; it keeps the constraints. Nothing: the wanted one is as good.
  std::optional<Eigen::Vector2d> instead(const Ego& ego, std::span<const Neighbour> neighbours,
                                         const BrakeConstraints& constraints,
                                         const Eigen::Vector2d& wanted_mps);

  void reset() { last_mps_.reset(); }

 private:
  /// Where somebody will be at each step of a path.
  struct Course {
    std::vector<Eigen::Vector2d> points_world_m;
    double apart_m;
    double weight;  ///< of a lack of clearance
  };

  bool mayMeet(const Ego& ego, const Neighbour& other) const;
  void addCourse(const Ego& ego, const Neighbour& other);
  void predictCourses(const Ego& ego, std::span<const Neighbour> neighbours, bool shielded);
  double clearanceOf(const Ego& ego, const Eigen::Vector2d& velocity_mps);

  const ShieldParameters& parameters_;
  std::vector<Course> courses_;
  std::size_t count_ = 0;                    // of the courses in use
  std::optional<Eigen::Vector2d> last_mps_;  // what was flown instead, while it lasts
  Path path_;
};

}  // namespace roundabout::planner::shield
