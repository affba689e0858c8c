#pragma once

#include <optional>

#include "mocap_bridge/sources/exposure_clock.h"
#include "mocap_bridge/sources/qualisys/parser.h"
#include "mocap_bridge/sources/source.h"
#include "mocap_bridge/sources/stream_buffer.h"

namespace roundabout::mocap_bridge::qualisys {

/// Bodies have the names of the settings, if those are as many as bodies in the data; else only
/// their places in the list, as ids.
class QualisysInterpreter final : public Interpreter {
 public:
  /// What a session has to answer.
  struct Heard {
    std::vector<std::string> texts;   ///< answers to commands
    std::vector<std::string> errors;  ///< refusals of commands
    std::vector<Event> events;
    bool data = false;
  };

  explicit QualisysInterpreter(const config::Mocap& mocap);

  void onPacket(const mocap_bridge::Packet& packet, PacketSink& sink) override;
  void onConnection() override;
  /// What follows may begin within a message: packets are passed over until one can be read.
  void onGap() override {
    buffer_.clear();
    gap_ = true;
  }
  std::vector<std::string> bodies() const override { return names_; }

  /// Since the last call.
  Heard takeHeard() { return std::exchange(heard_, {}); }
  /// The stream cannot be read any further: connect again.
  bool broken() const { return broken_; }
  bool namesKnown() const { return names_known_; }
  /// There are as many names as bodies in the last data.
  bool namesFit() const { return names_fit_; }
  /// QTM does not say what it streams: until it does, nobody may fly by what may be played back.
  void stateUnknown() { state_unknown_ = true; }
  /// What was said of names is old.
  void forgetNames() { names_known_ = false; }

 private:
  void onMessage(const Packet& message, core::Utime received, PacketSink& sink);
  void onEvent(Event event);
  const char* onData(Bytes payload, core::Utime received, PacketSink& sink);

  ExposureClock clock_;
  StreamBuffer buffer_;
  bool broken_ = false;
  bool gap_ = false;  // of this connection, something is missing
  bool names_known_ = false;
  bool names_fit_ = true;
  bool from_file_ = false;
  bool state_unknown_ = false;
  std::vector<std::string> names_;
  Heard heard_;
  Data data_;
  SourceFrame out_;
  std::int64_t number_ = 0;
};

}  // namespace roundabout::mocap_bridge::qualisys
