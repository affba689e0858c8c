#pragma once

#include <iosfwd>
#include <string>

namespace roundabout::planner {

/// Evaluates a network on observations, one JSON object a line with num_other_agents, ego (4
/// numbers) and others (7 numbers each, in the order in which they are fed); docs/observation.md.
/// Writes each line back with probs, value and action added. A bad line is named in `errors` and
/// left out. Returns how many were bad. Throws core::StartupError if the weights do not load.
int queryPolicy(const std::string& weights_path, std::istream& in, std::ostream& out,
                std::ostream& errors);

}  // namespace roundabout::planner
