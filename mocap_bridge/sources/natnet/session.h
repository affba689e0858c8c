#pragma once

#include <memory>
#include <string>

#include "mocap_bridge/sources/natnet/interpreter.h"
#include "mocap_bridge/sources/session_timer.h"
#include "mocap_bridge/sources/sockets.h"
#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge::natnet {

/// Talks to Motive: finds it, connects, asks for names and rate, synchronises clocks by echo, keeps
/// itself alive where frames come by unicast, and connects again when it falls silent. Packets of
/// other machines are counted and not looked at.
class NatnetSession final : public Source {
 public:
  /// Of `mocap` the server, interface, ports, group, transport, latency and rate. Without a server
  /// the first that answers a broadcast is taken. Throws core::StartupError: unknown host or
  /// interface, a group that is none, a socket that cannot be opened.
  explicit NatnetSession(const config::Mocap& mocap);

  void poll(core::Utime now, PacketSink& sink) override;
  void addDescriptors(std::vector<pollfd>& descriptors) const override;
  SourceStatus status() const override;

 private:
  void receive(UdpSocket& socket, core::Utime now, PacketSink& sink);
  void onDatagram(const UdpSocket::Received& datagram, std::uint16_t to_port, core::Utime now,
                  PacketSink& sink);
  void onServerInfo(core::Utime now);
  bool findsServer(const UdpSocket::Received& datagram);
  void onBroken(core::Utime now);
  void noteAnswer(core::Utime now);
  void noteRestart(core::Utime now);
  void openDataSocket(core::Utime now);
  void sendWhatIsDue(core::Utime now);
  void connect();
  void noteSilence(core::Utime now);
  bool multicast() const;
  std::uint32_t group() const;
  std::uint16_t dataPort() const;
  std::string where() const;
  void send(const std::vector<std::byte>& datagram) { command_.send(server_, datagram); }

  config::Mocap settings_;
  Endpoint server_;
  std::uint32_t interface_;
  bool searching_;  // no server was named and none has answered lately
  UdpSocket command_;
  std::unique_ptr<UdpSocket> data_;
  Endpoint data_at_;  // group or any, and port, that data_ was opened for
  NatnetInterpreter interpreter_;
  std::int64_t wrong_sender_ = 0;
  core::Utime began_ = 0;
  core::Utime last_answer_ = 0;
  core::Utime answering_since_ = 0;  // without 2 s of silence
  core::Utime last_restart_ = 0;
  int restarts_lately_ = 0;
  core::Utime last_frame_ = 0;
  core::Utime last_broken_frame_ = 0;
  core::Utime data_opened_ = 0;
  bool connected_ = false;
  SessionTimer connect_{500'000};
  SessionTimer echo_{250'000};
  SessionTimer keep_alive_{1'000'000};
  SessionTimer models_{1'000'000};
  SessionTimer bitstream_{1'000'000};
  SessionTimer rate_{1'000'000};
};

}  // namespace roundabout::mocap_bridge::natnet
