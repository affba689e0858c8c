#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace roundabout::cli {

/// What a process of a flight is for.
enum class Role { kLogger, kPlanner, kPerception, kFleet, kSim, kMocap };

/// Wall-clock limits, seconds.
struct DirectorLimits {
  double landing_s = 30.0;       ///< for all to be on the floor, from the order to land
  double fleet_return_s = 10.0;  ///< for a new fleet to take over, from the death of the old one
  double sim_linger_s = 2.0;     ///< from the death of the simulator to the end, so that the log
                                 ///< shows how the planners took it
};

/// What the supervisor shall do now.
enum class Direction {
  kGoOn,
  kLand,  ///< order all to land, and go on listening
  kEnd
};

/// Decides how a flight ends; knows neither processes nor messages. Times are wall-clock seconds
/// on any clock that does not jump.
///
/// | what happens              | what follows                                                    |
/// |---------------------------|-----------------------------------------------------------------|
/// | the simulator ends, 0     | end                                                             |
/// | the simulator dies        | nothing flies any more: linger, then end                        |
/// | a planner dies            | go on: its vehicle holds and lands by itself, the others go on  |
/// | fleet dies                | vehicles hold at their goals; land unless a new fleet takes over|
/// | the logger dies           | land: a flight without a log is no experiment                   |
/// | motion capture ends       | land; vehicles that see no states do so by themselves           |
/// | the user stops            | land                                                            |
/// | the mission ended in air  | land                                                            |
/// | `fly` itself fails        | land                                                            |
/// | all landed, or time is up | end                                                             |
class FlightDirector {
 public:
  /// s. What is heard of a process up to this long after its death it has said before.
  static constexpr double kEcho_s = 0.2;

  FlightDirector(std::vector<std::string> vehicles, DirectorLimits limits);

  void onFirstState() { flying_ = true; }
  void onEnd(Role role, const std::string& vehicle, bool clean, double now_s);
  void onFleetHeard(double now_s);
  void onPlannerHeard(const std::string& vehicle, bool on_floor, double now_s);
  void onStop();
  void onMissionOver();
  /// The fleet is done, and there is no simulator whose end would say so.
  void onFleetDone();
  void onFailure(const std::string& what);

  Direction decide(double now_s);
  /// Why it is landing or has ended; empty while all is well.
  const std::string& reason() const { return reason_; }
  /// It is landing or has ended before the mission was over.
  bool early() const { return early_; }
  /// Who was not on the floor when the time to land was up.
  const std::vector<std::string>& notLanded() const { return not_landed_; }

 private:
  struct VehicleView {
    std::optional<double> planner_death_s;
    bool on_floor = false;
  };

  std::vector<std::string> inTheAir() const;
  void land(const std::string& reason, bool early = true);

  std::map<std::string, VehicleView> vehicles_;
  DirectorLimits limits_;
  bool flying_ = false;
  bool sim_finished_ = false;
  bool landing_ = false;
  bool early_ = false;
  std::optional<double> sim_death_s_;
  std::optional<double> fleet_death_s_;
  std::optional<double> landing_since_s_;
  std::string reason_;
  std::vector<std::string> not_landed_;
};

}  // namespace roundabout::cli
