#include "cli/emulation.h"

#include <spdlog/fmt/fmt.h>

#include "mocap_bridge/sources/sockets.h"

namespace roundabout::cli {

std::vector<std::string> emulationOverrides(const std::string& protocol) {
  const auto [command_port, data_port] = mocap_bridge::freePorts();
  return {"source=" + protocol,
          "mocap.server=127.0.0.1",
          "mocap.interface=127.0.0.1",
          "mocap.bodies=[]",
          "mocap.axes=auto",
          "mocap.transport=auto",
          "mocap.group=\"\"",
          "mocap.scale=1",
          "mocap.rotation=xyz",
          "mocap.rate_hz=0",
          "mocap.latency_s=0.005",
          fmt::format("mocap.command_port={}", command_port),
          fmt::format("mocap.data_port={}", data_port)};
}

}  // namespace roundabout::cli
