#pragma once

#include <vector>

#include "planner/observation.h"
#include "planner/policies/ga3c_cadrl/others_reader.h"

namespace roundabout::planner {

/// How open the input gate of an LSTM was when one other agent was read, and what it owed to the
/// agent's state, to the hidden state that those before had left, and to its bias (paper, section
/// "LSTM Gate Dynamics"). The three parts add up to the mean.
struct GateStep {
  double mean = 0.0;  ///< over the units, 0 to 1
  double state_part = 0.0;
  double hidden_part = 0.0;
  double bias_part = 0.0;
};

/// One step for each of the others, in the order in which they are read. A part is the Euclidean
/// distance of the gate from what it would be without that input; the three are then scaled to add
/// up to the mean of the gate.
std::vector<GateStep> inputGateDynamics(const RecurrentReader& reader,
                                        std::span<const OtherInput> others);

}  // namespace roundabout::planner
