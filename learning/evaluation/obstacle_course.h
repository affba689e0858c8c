#pragma once

#include <string>

#include "learning/evaluation/evaluation.h"

namespace roundabout::learning {

/// Puts the obstacles of a file (config::readObstacles) in the way of every case.
void addObstacles(Suite& suite, const std::string& path);

/// Refuses a case in which an agent would start or end in an obstacle, and, where there are
/// obstacles, policies that do not avoid them. Throws core::StartupError.
void checkObstacles(const Evaluation& evaluation);

}  // namespace roundabout::learning
