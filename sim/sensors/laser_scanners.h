#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "common/config/experiment.h"
#include "common/core/laser_scan.h"
#include "common/core/random.h"
#include "common/core/tick_timer.h"
#include "sim/dynamics/dynamics.h"
#include "sim/pedestrians/pedestrian.h"
#include "sim/sensors/lidar.h"

namespace roundabout::sim {

/// The lidars of an experiment's vehicles. They see the bodies of the other vehicles, which are
/// upright cylinders without end as everywhere in Roundabout, the legs of pedestrians, the
/// obstacles and, if the experiment says so, the edges of the room as walls.
class LaserScanners {
 public:
  struct Sweep {
    std::size_t vehicle;
    core::LaserScan scan;
  };

  explicit LaserScanners(const config::Experiment& experiment);

  /// The sweeps that are due: each lidar's at the first call at or after each multiple of its
  /// period. Valid until the next call. bodies: in the order of the experiment.
  std::span<const Sweep> sweep(core::Utime now, std::span<const BodyState> bodies,
                               std::span<const Pedestrian> people = {});

 private:
  struct Scanner {
    std::size_t vehicle;
    Lidar lidar;
    core::TickTimer timer;
    core::RandomStream noise;
    std::vector<core::Polygon> outlines;  // of what its plane cuts
    double last_heading_rad = 0.0;
    core::Utime last_sweep = 0;
  };

  static SensorMotion motionOf(Scanner& scanner, core::Utime now, const BodyState& own);

  double leg_radius_m_;
  std::vector<double> radii_m_;
  Eigen::AlignedBox2d room_;
  std::vector<Scanner> scanners_;
  std::vector<Disc> discs_;
  std::vector<Sweep> sweeps_;
};

}  // namespace roundabout::sim
