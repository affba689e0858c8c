#include "cli/commands.h"

#include "cli/doctor/doctor_command.h"
#include "cli/fly_command.h"
#include "cli/mission_command.h"
#include "cli/operator_commands.h"
#include "cli/perception_command.h"
#include "cli/replay/replay_command.h"
#include "cli/script_command.h"
#include "cli/spy_command.h"
#include "learning/evaluation/crossing/crossing_command.h"
#include "learning/evaluation/evaluate_command.h"
#include "learning/training/train_command.h"
#include "logs/log_commands.h"
#include "mocap_bridge/tools/mocap_commands.h"
#include "planner/policy_tools/policy_commands.h"

namespace roundabout::cli {

void addCommands(CLI::App& app, int& exit_status) {
  addFlyCommand(app, exit_status);
  addOrderCommand(app, exit_status);
  addMissionCommand(app, exit_status);
  learning::addEvaluateCommand(app, exit_status);
  learning::addCrossCommand(app, exit_status);
  learning::addTrainCommand(app, exit_status);
  logs::addLogCommands(app);
  mocap_bridge::addMocapCommands(app, exit_status);
  addPerceptionCommand(app);
  addReplayCommand(app, exit_status);
  addScriptCommand(app);
  addSpyCommand(app, exit_status);
  addDoctorCommand(app, exit_status);
  planner::addPolicyCommands(app);
}

}  // namespace roundabout::cli
