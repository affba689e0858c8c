#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "sim/pedestrians/pedestrian.h"

namespace roundabout::sim {

/// Recorded people (ETH data set's obsmat.txt; Pellegrini et al., "You'll Never Walk Alone", ICCV
/// 2009): one line a person and annotated frame, eight columns "frame id x z y vx vz vy", m and
/// m/s. Columns z, vx, vz and vy are not used. Between annotations a person moves on a Catmull-Rom
/// spline; before its first and after its last there is nobody.
class RecordedPeople {
 public:
  static constexpr double kExtendS = 5.0;

  /// Throws core::StartupError: no such file, not eight finite numbers in a line (the line is
  /// named), a person twice in a frame, nobody.
  explicit RecordedPeople(const config::Recording& recording, const std::string& where);

  /// Those who are there, seconds after the first line plus recording.start_s; in order of their
  /// ids. Heading and gait are left to who walks them.
  void at(double seconds, std::vector<Pedestrian>& people) const;

  double durationS() const { return duration_s_; }  ///< of the whole recording

 private:
  struct Sample {
    double time_s;  // since the first line
    Eigen::Vector2d position_m;
  };
  struct Person {
    std::int32_t id;
    std::vector<Sample> samples;  // time grows
  };

  static Eigen::Vector2d tangent(const std::vector<Sample>& samples, std::size_t i);
  static Pedestrian between(const Person& person, std::size_t next, double time_s);
  static Pedestrian beyond(const Person& person, std::size_t nearest, double time_s);

  double start_s_;
  double duration_s_ = 0.0;
  std::vector<Person> people_;
};

}  // namespace roundabout::sim
