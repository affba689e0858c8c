#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "perception/scan/scan_points.h"

namespace roundabout::perception {

/// Beams next to each other that hit one surface, as far as the scan can tell.
struct Segment {
  std::vector<std::size_t> beams;  ///< that hit it, in order
  double width_m = 0.0;            ///< largest extent: between its ends, or from them to its middle
  bool hidden_begin = false;       ///< what is nearer hides where it begins
  bool hidden_end = false;
};

struct BreakpointSettings {
  double worst_incidence_rad = 0.17;  ///< lambda: surfaces seen more slantingly fall apart
  double range_noise_m = 0.02;        ///< standard deviation of a range
  int most_missed_beams = 2;          ///< so many beams without an echo do not end a surface
  std::size_t least_beams = 2;        ///< fewer are mixed pixels: half on an edge, half behind it
};

/// Adaptive breakpoints (Borges, Aldon: Line Extraction in 2D Range Images for Mobile Robotics,
/// JIRS 2004): a surface ends where the next point is farther away than
/// r sin(dphi) / sin(lambda - dphi) + 3 sigma.
void findSegments(const ScanPoints& points, const BreakpointSettings& settings,
                  std::vector<Segment>& segments);

/// From far away the legs of people who stand side by side are one segment. If it is legs with gaps
/// between them, each of them; else nothing: it is a wall.
std::vector<Segment> legsOf(const ScanPoints& points, const Segment& segment, double widest_leg_m);

}  // namespace roundabout::perception
