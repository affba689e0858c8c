#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "common/config/experiment.h"
#include "fleet/formations/stroke_font.h"

namespace roundabout::fleet {

enum class Verb { kTakeOff, kFormation, kGoTo, kHold, kWait, kWaitUntil, kLand };

/// What kWaitUntil waits for: everybody at its goal; somebody's word; a time.
enum class Event { kFormed, kGoOn, kTime };

/// It makes no sense with all vehicles on the floor.
bool needsAir(Verb verb);

/// One thing that the fleet does: a spelled word has become one step a letter. Goals are checked.
struct Step {
  Verb verb = Verb::kWait;
  std::string name;                       ///< formation: "C"; else empty
  std::vector<Eigen::Vector3d> points_m;  ///< kFormation: up to one a vehicle; kGoTo: one
  bool at_own_heights = false;            ///< kFormation: each vehicle flies at its own height
  std::size_t vehicle = 0;                ///< kGoTo: index
  double seconds = 0.0;  ///< kWait; kFormation and kHold: how long to stay; kTime: since take-off
  Event event = Event::kTime;  ///< kWaitUntil
};

using StepsOrRefusal = std::variant<std::vector<Step>, std::string>;

/// Turns what a file or a message asks for into steps, or into the reason why it cannot be flown.
class MissionReader {
 public:
  /// Throws core::StartupError if the font of letters is not installed.
  explicit MissionReader(const config::Experiment& experiment);

  StepsOrRefusal read(const config::MissionStep& asked) const;

  /// The experiment file's mission. Throws core::StartupError that names mission[k].
  std::vector<Step> readFile() const;

 private:
  StepsOrRefusal spell(const config::MissionStep& asked) const;
  StepsOrRefusal formation(const config::MissionStep& asked) const;
  StepsOrRefusal goTo(const config::MissionStep& asked) const;
  static StepsOrRefusal waitUntil(const config::MissionStep& asked);
  double stayS(const config::MissionStep& asked) const;

  const config::Experiment& experiment_;
  StrokeFont font_;
};

}  // namespace roundabout::fleet
