#pragma once

#include "mocap_bridge/sources/sockets.h"
#include "mocap_bridge/sources/vicon_udp/interpreter.h"

namespace roundabout::mocap_bridge::vicon {

/// Listens to what Vicon Tracker sends; there is no handshake.
class ViconSession final : public Source {
 public:
  /// Of `mocap` the server (empty: any), interface, data port, rotation, latency and rate. Throws
  /// core::StartupError.
  explicit ViconSession(const config::Mocap& mocap);

  void poll(core::Utime now, PacketSink& sink) override;
  void addDescriptors(std::vector<pollfd>& descriptors) const override {
    descriptors.push_back({socket_.descriptor(), POLLIN, 0});
  }
  SourceStatus status() const override;

 private:
  void onDatagram(const UdpSocket::Received& datagram, core::Utime now, PacketSink& sink);
  void noteSilence(core::Utime now);

  std::uint32_t named_;   // by the file; any: none
  std::uint32_t server_;  // any, until one has sent, and again after silence
  UdpSocket socket_;
  ViconInterpreter interpreter_;
  std::int64_t wrong_sender_ = 0;
  core::Utime began_ = 0;
  core::Utime last_packet_ = 0;
  bool connected_ = false;
};

}  // namespace roundabout::mocap_bridge::vicon
