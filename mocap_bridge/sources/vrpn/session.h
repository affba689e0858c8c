#pragma once

#include <memory>

#include "mocap_bridge/sources/session_timer.h"
#include "mocap_bridge/sources/sockets.h"
#include "mocap_bridge/sources/vrpn/interpreter.h"

namespace roundabout::mocap_bridge::vrpn {

/// A TCP client of a VRPN server, which connects again for as long as it runs.
class VrpnSession final : public Source {
 public:
  /// Of `mocap` the server, command port and latency. Throws core::StartupError: unknown host.
  explicit VrpnSession(const config::Mocap& mocap);

  void poll(core::Utime now, PacketSink& sink) override;
  void addDescriptors(std::vector<pollfd>& descriptors) const override;
  SourceStatus status() const override;

 private:
  void connect(core::Utime now);
  void receive(core::Utime now, PacketSink& sink);
  void noteSilence(core::Utime now);

  Endpoint server_;
  std::unique_ptr<TcpStream> stream_;
  bool cookie_sent_ = false;
  VrpnInterpreter interpreter_;
  SessionTimer reconnect_{core::kMicrosPerSecond};
  core::Utime began_ = 0;
  core::Utime last_packet_ = 0;
};

}  // namespace roundabout::mocap_bridge::vrpn
