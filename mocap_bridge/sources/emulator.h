#pragma once

#include <string>
#include <vector>

#include <poll.h>

#include "common/core/time.h"
#include "mocap_bridge/sources/source_frame.h"

namespace roundabout::mocap_bridge {

/// Where and how an emulated system serves.
struct EmulatorSettings {
  std::string address = "127.0.0.1";    ///< of the interface that it serves on
  int command_port = 0;                 ///< 0: the protocol's default
  int data_port = 0;                    ///< the same
  std::string group;                    ///< multicast; empty: the protocol's default
  std::string transport = "multicast";  ///< natnet: multicast or unicast
  std::string version;                  ///< empty: the protocol's most usual
  std::string to = "127.0.0.1";         ///< vicon_udp: who gets the datagrams
  double rate_hz = 200.0;               ///< what it says of its cameras
};

/// Speaks a motion-capture system's side of its protocol, for tests and flights without a lab. It
/// never blocks and knows the time only from its caller: its own clock, which need not be that of
/// whoever listens.
class Emulator {
 public:
  virtual ~Emulator() = default;

  /// Answers what has arrived.
  virtual void poll(core::Utime now) = 0;
  /// Sends a frame that was exposed at frame.exposure_utime, on the same clock as now. Bodies are
  /// in the axes of the protocol; their names and ids must not change but by calls of their own.
  virtual void send(const SourceFrame& frame, core::Utime now) = 0;
  virtual void addDescriptors(std::vector<pollfd>& descriptors) const = 0;
  /// What it listens on, or sends to where it does not listen.
  virtual int commandPort() const = 0;
};

}  // namespace roundabout::mocap_bridge
