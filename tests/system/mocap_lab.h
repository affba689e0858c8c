#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "mocap_bridge/sources/sockets.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {

/// A lab with an emulated motion-capture system, on ports of its own.
class MocapLab : public FlightLab {
 protected:
  std::string labFile(const std::string& source, const std::string& more = "") const {
    return "source: " + source +
           "\nmocap: {server: 127.0.0.1, interface: 127.0.0.1, command_port: " +
           std::to_string(command_port_) + ", data_port: " + std::to_string(data_port_) + more +
           "}\n";
  }
  cli::ChildProcess& startEmulator(const std::string& protocol,
                                   const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"mocap",
                                       "emulate",
                                       protocol,
                                       "--command-port",
                                       std::to_string(command_port_),
                                       "--data-port",
                                       std::to_string(data_port_)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("roundabout", arguments);
  }
  // Everything of the state messages that a listener could tell two publishers apart by.
  struct Traffic {
    std::set<std::string> channels;
    std::set<std::int64_t> fingerprints;
    std::vector<roundabout_msgs::vehicle_states_t> messages;
  };
  Traffic listen(double seconds) {
    Traffic traffic;
    bus::LcmBus bus(url());
    bus.subscribePrefix("", [&](const bus::Received& received) {
      traffic.channels.insert(std::string(received.channel));
      traffic.fingerprints.insert(static_cast<std::int64_t>(bus::fingerprintOf(received.payload)));
      roundabout_msgs::vehicle_states_t message;
      if (received.channel == bus::kStatesChannel &&
          bus::decode(received.payload, message) == nullptr) {
        traffic.messages.push_back(message);
      }
    });
    const auto until = std::chrono::steady_clock::now() +
                       std::chrono::milliseconds(static_cast<int>(1000 * seconds));
    while (std::chrono::steady_clock::now() < until) {
      bus.handle(std::chrono::milliseconds(10));
    }
    return traffic;
  }

  const std::pair<int, int> ports_ = mocap_bridge::freePorts();
  int command_port_ = ports_.first;
  int data_port_ = ports_.second;
};

}  // namespace roundabout::test
