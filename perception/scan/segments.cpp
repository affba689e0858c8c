#include "perception/scan/segments.h"

#include <algorithm>
#include <cmath>

namespace roundabout::perception {

namespace {

// Farther than this behind the neighbouring beam's echo: it is hidden, not ended.
constexpr double kHides_m = 0.2;
constexpr double kNearlyOutOfReach = 0.93;

// Between legs that are one segment: this wide, and so many times the distance of neighbouring
// points.
constexpr double kLeastGap_m = 0.08;
constexpr double kGapFactor = 2.5;

double breakDistance(double range_m, std::size_t steps, const ScanPoints& points,
                     const BreakpointSettings& settings) {
  const double angle_rad = static_cast<double>(steps) * std::abs(points.angle_step_rad);
  const double incidence_rad = std::max(settings.worst_incidence_rad - angle_rad, 0.02);
  return range_m * std::sin(angle_rad) / std::sin(incidence_rad) + 3.0 * settings.range_noise_m;
}

bool belongTogether(const ScanPoints& points, std::size_t a, std::size_t b, std::size_t steps,
                    const BreakpointSettings& settings) {
  const double range_m = std::min(points.range_m[a], points.range_m[b]);
  return (points.world_m[a] - points.world_m[b]).norm() <=
         breakDistance(range_m, steps, points, settings);
}

double widthOf(const ScanPoints& points, const std::vector<std::size_t>& beams) {
  const Eigen::Vector2d& first = points.world_m[beams.front()];
  const Eigen::Vector2d& last = points.world_m[beams.back()];
  const Eigen::Vector2d& middle = points.world_m[beams[beams.size() / 2]];
  return std::max({(last - first).norm(), (middle - first).norm(), (last - middle).norm()});
}

/// Or the end of what the lidar reaches.
bool hides(const ScanPoints& points, std::size_t beam, std::size_t neighbour) {
  if (points.hit[neighbour] == 0) {
    return points.range_m[beam] > kNearlyOutOfReach * points.range_m[neighbour];
  }
  return points.hit[neighbour] != 0 && points.range_m[neighbour] + kHides_m < points.range_m[beam];
}

}  // namespace

void findSegments(const ScanPoints& points, const BreakpointSettings& settings,
                  std::vector<Segment>& segments) {
  segments.clear();
  const std::size_t beams = points.size();
  const auto gap = static_cast<std::size_t>(settings.most_missed_beams) + 1;
  const auto continues = [&](const Segment& segment, std::size_t beam) {
    const std::size_t steps = beam - segment.beams.back();
    return steps <= gap && belongTogether(points, segment.beams.back(), beam, steps, settings);
  };
  for (std::size_t i = 0; i < beams; ++i) {
    if (points.hit[i] == 0) {
      continue;
    }
    // One beam half on an edge does not divide what is behind it.
    const std::size_t count = segments.size();
    if (count > 1 && segments[count - 1].beams.size() == 1 && !continues(segments[count - 1], i) &&
        continues(segments[count - 2], i)) {
      segments.pop_back();
    } else if (count == 0 || !continues(segments.back(), i)) {
      segments.emplace_back();
    }
    segments.back().beams.push_back(i);
  }
  if (points.full_circle && segments.size() > 1) {
    Segment& first = segments.front();
    Segment& last = segments.back();
    const std::size_t steps = first.beams.front() + beams - last.beams.back();
    if (steps <= gap &&
        belongTogether(points, last.beams.back(), first.beams.front(), steps, settings)) {
      last.beams.insert(last.beams.end(), first.beams.begin(), first.beams.end());
      segments.erase(segments.begin());
    }
  }
  std::erase_if(segments, [&](const Segment& segment) {
    return segment.beams.size() < settings.least_beams;
  });
  for (Segment& segment : segments) {
    segment.width_m = widthOf(points, segment.beams);
    const std::size_t begin = segment.beams.front();
    const std::size_t end = segment.beams.back();
    const bool at_start = begin == 0 && !points.full_circle;
    const bool at_end = end + 1 == beams && !points.full_circle;
    // The edge of the field of view hides as well.
    segment.hidden_begin = at_start || hides(points, begin, (begin + beams - 1) % beams);
    segment.hidden_end = at_end || hides(points, end, (end + 1) % beams);
  }
}

std::vector<Segment> legsOf(const ScanPoints& points, const Segment& segment, double widest_leg_m) {
  std::vector<double> spacings_m;
  for (std::size_t i = 1; i < segment.beams.size(); ++i) {
    spacings_m.push_back(
        (points.world_m[segment.beams[i]] - points.world_m[segment.beams[i - 1]]).norm());
  }
  std::vector<double> sorted_m = spacings_m;
  const auto middle = sorted_m.begin() + static_cast<std::ptrdiff_t>(sorted_m.size() / 2);
  std::nth_element(sorted_m.begin(), middle, sorted_m.end());
  const double gap_m = std::max(kLeastGap_m, kGapFactor * *middle);
  std::vector<Segment> legs{{{segment.beams.front()}}};
  for (std::size_t i = 1; i < segment.beams.size(); ++i) {
    if (spacings_m[i - 1] > gap_m) {
      legs.emplace_back();
    }
    legs.back().beams.push_back(segment.beams[i]);
  }
  for (Segment& leg : legs) {
    leg.width_m = widthOf(points, leg.beams);
    if (leg.width_m > widest_leg_m || leg.beams.size() < 2) {
      return {};
    }
  }
  return legs;
}

}  // namespace roundabout::perception
