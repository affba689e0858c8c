#pragma once

#include <string>
#include <vector>

namespace roundabout::cli {

enum class Health { kWell, kWorthKnowing, kWrong };

/// What was looked at, what was found, and the command that mends it.
struct Finding {
  Health health = Health::kWell;
  std::string what;
  std::string found;
  std::string mend;  ///< empty if nothing is to be done
};

/// Looks at this machine as far as LCM on this URL and Roundabout need it. Listens for a second;
/// publishes one message on a channel of its own (ROUNDABOUT_DOCTOR).
std::vector<Finding> examine(const std::string& lcm_url);

// The parts that can be judged without the machine:

/// net.core.rmem_max in bytes; 0 or less: it cannot be read.
Finding judgeReceiveBuffer(long rmem_max_bytes);
/// interface: through which multicast goes, empty if there is no route; loopback: it is lo.
Finding judgeRoute(const std::string& interface, bool loopback, int ttl, const std::string& error);
/// state: what adjtimex() returned; max_error_s: what the kernel believes at most.
Finding judgeClock(bool synchronised, double max_error_s);

}  // namespace roundabout::cli
