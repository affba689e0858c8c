#pragma once

#include <string>

namespace roundabout::app {

/// Makes spdlog's free functions write lines like "12:34:56.789 planner:hex1 warning  text" to
/// stderr, from info on, or from debug on if verbose.
void setUpLog(const std::string& label, bool verbose);

}  // namespace roundabout::app
