#include "mocap_bridge/sources/table.h"

#include <array>
#include <string>

#include "common/core/error.h"

namespace roundabout::mocap_bridge {

Protocol natnetProtocol();
Protocol qualisysProtocol();
Protocol vrpnProtocol();
Protocol viconUdpProtocol();

std::span<const Protocol> protocols() {
  static const std::array kProtocols = {
      natnetProtocol(),
      qualisysProtocol(),
      vrpnProtocol(),
      viconUdpProtocol(),
  };
  return kProtocols;
}

const Protocol& protocolNamed(std::string_view name) {
  std::string names;
  for (const Protocol& protocol : protocols()) {
    if (protocol.name == name) {
      return protocol;
    }
    names += (names.empty() ? "" : ", ") + std::string(protocol.name);
  }
  throw core::StartupError("mocap", "protocol", "one of " + names, "\"" + std::string(name) + "\"");
}

}  // namespace roundabout::mocap_bridge
