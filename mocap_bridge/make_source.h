#pragma once

#include <memory>
#include <string>

#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge {

/// What the experiment's `source` names: a session of a protocol, or a replay. Throws
/// core::StartupError: another source, or as the session.
std::unique_ptr<Source> makeSource(const config::Experiment& experiment);

/// What mocap.axes "auto" means for that source.
std::string usualAxes(const config::Experiment& experiment);

}  // namespace roundabout::mocap_bridge
