#include "planner/linear_program/linear_program.h"

#include <algorithm>
#include <cmath>

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

// Of margins in m/s, and of the sine between directions that count as parallel.
constexpr double kTolerance = 1e-10;

// A line of velocities: foot + s * direction, direction of unit length.
struct Line {
  Vector2d foot;  // point nearest to zero velocity
  Vector2d direction;
};

// Both objectives know their optimum in a disc round zero and on a piece of a line.
struct Nearest {
  Vector2d target;

  Vector2d inDisc(double radius) const {
    const double length = target.norm();
    return length > radius ? Vector2d(target * (radius / length)) : target;
  }
  double onLine(const Line& line, double low, double high) const {
    return std::clamp(line.direction.dot(target - line.foot), low, high);
  }
};

struct Farthest {
  Vector2d direction;

  Vector2d inDisc(double radius) const { return direction * radius; }
  double onLine(const Line& line, double low, double high) const {
    const double slope = direction.dot(line.direction);
    if (std::abs(slope) < kTolerance) {
      return std::clamp(0.0, low, high);
    }
    return slope > 0.0 ? high : low;
  }
};

// Optimum on the edge of one half-plane, within the disc and the other half-planes. False, and
// velocity as it was, if they leave nothing of the edge.
template <class Objective>
bool optimiseOnEdge(const HalfPlane& edge, std::span<const HalfPlane> others, double max_speed,
                    const Objective& objective, Vector2d& velocity) {
  const double half_chord_squared = max_speed * max_speed - edge.offset_mps * edge.offset_mps;
  if (half_chord_squared < 0.0) {
    return false;
  }
  const Line line{edge.normal * edge.offset_mps, {-edge.normal.y(), edge.normal.x()}};
  double high = std::sqrt(half_chord_squared);
  double low = -high;
  for (const HalfPlane& other : others) {
    const double slope = other.normal.dot(line.direction);
    const double foot_margin = other.margin(line.foot);
    if (std::abs(slope) < kTolerance) {
      if (foot_margin < -kTolerance) {
        return false;
      }
    } else if (slope > 0.0) {
      low = std::max(low, -foot_margin / slope);
    } else {
      high = std::min(high, -foot_margin / slope);
    }
    if (low > high) {
      return false;
    }
  }
  velocity = line.foot + line.direction * objective.onLine(line, low, high);
  return true;
}

// Adds one half-plane after the other: the optimum stays, or moves to the edge of the new one.
// Returns how many could be kept; velocity is the optimum under those.
template <class Objective>
std::size_t optimise(std::span<const HalfPlane> half_planes, double max_speed,
                     const Objective& objective, Vector2d& velocity) {
  velocity = objective.inDisc(max_speed);
  for (std::size_t i = 0; i < half_planes.size(); ++i) {
    if (half_planes[i].margin(velocity) < -kTolerance &&
        !optimiseOnEdge(half_planes[i], half_planes.first(i), max_speed, objective, velocity)) {
      return i;
    }
  }
  return half_planes.size();
}

// Where b's margin is at least a's. The normals differ by more than the tolerance.
HalfPlane whereLessViolated(const HalfPlane& a, const HalfPlane& b) {
  const Vector2d normal = b.normal - a.normal;
  const double length = normal.norm();
  return {normal / length, (b.offset_mps - a.offset_mps) / length};
}

}  // namespace

VelocityChoice LinearProgram::solve(std::span<const HalfPlane> half_planes,
                                    const Vector2d& preferred_mps, double max_speed_mps,
                                    std::size_t hard) {
  relative_.reserve(half_planes.size());
  VelocityChoice choice;
  const std::size_t kept =
      optimise(half_planes, max_speed_mps, Nearest{preferred_mps}, choice.velocity_mps);
  if (kept < hard) {
    return solve(half_planes.first(hard), preferred_mps, max_speed_mps);
  }
  // The third dimension is the violation of the worst half-plane. One that is violated more than
  // the worst so far becomes the worst: it is then made as small as it gets without letting an
  // earlier one become worse.
  for (std::size_t i = kept; i < half_planes.size(); ++i) {
    const HalfPlane& worst = half_planes[i];
    if (-worst.margin(choice.velocity_mps) <= choice.violation_mps + kTolerance) {
      continue;
    }
    relative_.assign(half_planes.begin(), half_planes.begin() + static_cast<std::ptrdiff_t>(hard));
    for (const HalfPlane& earlier : half_planes.subspan(hard, i - hard)) {
      if ((earlier.normal - worst.normal).norm() > kTolerance) {
        relative_.push_back(whereLessViolated(worst, earlier));
      }
    }
    Vector2d candidate;
    if (optimise(relative_, max_speed_mps, Farthest{worst.normal}, candidate) == relative_.size()) {
      choice.velocity_mps = candidate;
    }
    choice.violation_mps = -worst.margin(choice.velocity_mps);
  }
  return choice;
}

}  // namespace roundabout::planner
