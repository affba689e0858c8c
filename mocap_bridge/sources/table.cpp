#include "mocap_bridge/sources/table.h"

#include <array>
#include <string>

#include "common/config/mocap_protocols.h"
#include "common/core/error.h"

namespace roundabout::mocap_bridge {

#define ROUNDABOUT_DECLARE(name) \
  namespace name {               \
  Protocol protocol();           \
  }
ROUNDABOUT_MOCAP_PROTOCOLS(ROUNDABOUT_DECLARE)
#undef ROUNDABOUT_DECLARE

#define ROUNDABOUT_ENTRY(name) name::protocol(),
std::span<const Protocol> protocols() {
  static const std::array kProtocols = {ROUNDABOUT_MOCAP_PROTOCOLS(ROUNDABOUT_ENTRY)};
  return kProtocols;
}
#undef ROUNDABOUT_ENTRY

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
