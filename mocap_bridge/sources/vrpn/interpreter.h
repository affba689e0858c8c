#pragma once

#include <map>

#include "mocap_bridge/sources/exposure_clock.h"
#include "mocap_bridge/sources/frame_assembler.h"
#include "mocap_bridge/sources/source.h"
#include "mocap_bridge/sources/stream_buffer.h"
#include "mocap_bridge/sources/vrpn/parser.h"

namespace roundabout::mocap_bridge::vrpn {

/// Poses of one frame come as single messages, with one stamp or each with its own shortly after
/// the other's; the frame has the first. A sender is a body, and so is each of its sensors beyond
/// the first. What is not tracked is not sent.
class VrpnInterpreter final : public Interpreter {
 public:
  explicit VrpnInterpreter(const config::Mocap& mocap);

  void onPacket(const Packet& packet, PacketSink& sink) override;
  /// A new connection has ids of its own.
  void onConnection() override;
  /// What follows may begin within a message: packets are passed over until one can be read.
  void onGap() override {
    buffer_.clear();
    gap_ = true;
  }
  std::vector<std::string> bodies() const override;

  /// The stream cannot be read any further: connect again.
  bool broken() const { return broken_; }
  bool greeted() const { return greeted_; }
  std::string greeting() const { return greeting_; }

 private:
  bool readCookie(Bytes& stream, PacketSink& sink);
  void onMessage(const Message& message, core::Utime received, PacketSink& sink);
  void onPose(const Message& message, core::Utime received, PacketSink& sink);
  void emit(const SourceFrame& frame, PacketSink& sink);
  bool has(const std::string& body) const;
  bool joins(std::int64_t stamp_us, const std::string& body) const;
  std::string bodyName(const Message& message, std::int32_t sensor) const;
  void fail(const char* kind, const char* reason, PacketSink& sink);

  ExposureClock clock_;
  StreamBuffer buffer_;
  bool greeted_ = false;
  bool broken_ = false;
  bool gap_ = false;  // of this connection, something is missing
  std::string greeting_;
  std::map<std::int32_t, std::string> senders_;
  std::map<std::int32_t, std::string> types_;
  std::map<std::string, std::int64_t> ids_;  // of bodies, in the order of their first pose
  FrameAssembler assembler_;
  std::int64_t frame_stamp_us_ = 0;
  std::map<std::string, std::int64_t> stamps_us_;  // of the frame's bodies
  std::int64_t last_stamp_us_ = 0;
  std::int64_t number_ = 0;
};

}  // namespace roundabout::mocap_bridge::vrpn
