#include "cli/emulation.h"

#include <spdlog/fmt/fmt.h>

#include "mocap_bridge/sources/sockets.h"

namespace roundabout::cli {

std::vector<std::string> emulationOverrides(const std::string& protocol) {
  // Both held until both are known: a port that was given back may be given again.
  const mocap_bridge::UdpSocket command("a free port", {mocap_bridge::kLoopback, 0});
  const mocap_bridge::UdpSocket data("a free port", {mocap_bridge::kLoopback, 0});
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
          fmt::format("mocap.command_port={}", command.port()),
          fmt::format("mocap.data_port={}", data.port())};
}

}  // namespace roundabout::cli
