#pragma once

#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "planner/policies/ga3c_cadrl/network.h"
#include "planner/policy_tools/gates/dynamics.h"
#include "planner/policy_tools/gates/scene.h"

namespace roundabout::planner {

/// What happened in the LSTM's input gate in one scene.
struct GateAnalysis {
  GateScene scene;
  Observation observation;      ///< of the others that were read, in their order
  std::vector<GateStep> steps;  ///< one for each of them
};

/// The network's own order, room for others and normalisation apply.
/// Throws core::StartupError if the network in `path` has no LSTM.
GateAnalysis analyseGates(const Ga3cCadrlWeights& weights, const std::string& path,
                          GateScene scene);

/// One row for each agent that was read: scene, its number from 1, its gap in metres, the parts and
/// the mean.
void writeGatesCsv(const std::vector<GateAnalysis>& analyses, std::ostream& out);

}  // namespace roundabout::planner
