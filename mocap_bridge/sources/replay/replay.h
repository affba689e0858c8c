#pragma once

#include <memory>

#include "mocap_bridge/sources/replay/packet_feed.h"
#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge {

/// Plays a recording: packets through the interpreter of their protocol, or the VEHICLE_STATES of
/// an LCM event log as bodies of the vehicles' names. Data keep the times at which they were
/// recorded; the wall clock only says when they come: `speed` times as fast, or with speed 0 one
/// frame at every poll.
class ReplaySource final : public Source {
 public:
  /// Of `mocap` the file, speed, protocol and version. Throws core::StartupError as readPacketFile
  /// and the interpreter.
  explicit ReplaySource(const config::Mocap& mocap);
  ~ReplaySource() override;

  void poll(core::Utime now, PacketSink& sink) override;
  void addDescriptors(std::vector<pollfd>&) const override {}
  SourceStatus status() const override;
  bool finished() const override { return next_ >= times_.size(); }
  core::Utime dataTime(core::Utime now) const override;

 private:
  void play(std::size_t index, PacketSink& sink);

  double speed_;
  std::string file_;
  PacketFile packets_;
  std::vector<SourceFrame> frames_;  // of an event log, instead of packets
  std::vector<core::Utime> times_;   // when each was recorded
  std::unique_ptr<Interpreter> interpreter_;
  std::optional<PacketFeed> feed_;
  std::size_t next_ = 0;
  std::optional<core::Utime> began_;
};

/// True for what lcm-logger writes.
bool looksLikeEventLog(const std::string& path);
/// Every VEHICLE_STATES of an event log that can be decoded, as frames; a damaged rest is left out.
std::vector<SourceFrame> readStatesOfLog(const std::string& path);

}  // namespace roundabout::mocap_bridge
