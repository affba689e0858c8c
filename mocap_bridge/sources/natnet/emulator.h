#pragma once

#include <map>

#include "mocap_bridge/sources/emulator.h"
#include "mocap_bridge/sources/natnet/protocol.h"
#include "mocap_bridge/sources/sockets.h"

namespace roundabout::mocap_bridge::natnet {

/// Motive as seen from the network: server info, model definitions, echoes, "FrameRate" and
/// "Bitstream", frames of any version from 2.5 to 4.2 by multicast or to the clients that connected
/// and keep themselves alive.
class NatnetEmulator final : public Emulator {
 public:
  /// Throws core::StartupError: a version that is not known, a port in use.
  explicit NatnetEmulator(const EmulatorSettings& settings);

  void poll(core::Utime now) override;
  void send(const SourceFrame& frame, core::Utime now) override;
  void addDescriptors(std::vector<pollfd>& descriptors) const override;
  /// Frames and definitions are of that version from now on, as if another client had asked for it;
  /// the answer to "Bitstream" says so, the server info does not.
  void changeBitstream(Version version) { bitstream_ = version; }
  int commandPort() const override { return command_.port(); }

 private:
  void answer(const UdpSocket::Received& request, core::Utime now);
  void answerText(const Endpoint& client, std::string_view text);
  void learnModels(const SourceFrame& frame);

  ServerInfo info_;
  Version bitstream_;
  double rate_hz_;
  UdpSocket command_;
  UdpSocket data_;
  ModelDef models_;
  bool models_changed_ = false;
  std::map<std::pair<std::uint32_t, std::uint16_t>, core::Utime> clients_;  // last heard
  Frame frame_;
};

}  // namespace roundabout::mocap_bridge::natnet
