#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "mocap_bridge/sources/emulator.h"
#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge {

/// What a protocol brings along. Its folder defines one; the table names it.
struct Protocol {
  std::string_view name;
  std::string_view usual_axes;  ///< what `axes: auto` means
  int stream_port;              ///< of its TCP server; 0: spoken in datagrams
  std::unique_ptr<Source> (*make_session)(const config::Mocap&);
  std::unique_ptr<Interpreter> (*make_interpreter)(const config::Mocap&);
  std::unique_ptr<Emulator> (*make_emulator)(const EmulatorSettings&);
};

/// All protocols, in the order of the table (common/config/mocap_protocols.h).
std::span<const Protocol> protocols();
/// Throws core::StartupError that lists the protocols.
const Protocol& protocolNamed(std::string_view name);

}  // namespace roundabout::mocap_bridge
