#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace roundabout::bus {

/// Which of the channels somebody publishes on within the duration (wall clock), in their order.
/// The bus should be an object made for this question: subscriptions last as long as their bus.
std::vector<std::string> heardWithin(std::chrono::milliseconds duration, Bus& listener,
                                     const std::vector<std::string>& channels);

}  // namespace roundabout::bus
