#pragma once

#include <map>
#include <optional>

#include "mocap_bridge/sources/exposure_clock.h"
#include "mocap_bridge/sources/natnet/parser.h"
#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge::natnet {

class NatnetInterpreter final : public Interpreter {
 public:
  struct Settings {
    std::optional<Version> version;  ///< until a server says another
    double latency_s = 0.005;        ///< exposure to arrival, for servers before 3.0
    double rate_hz = 0.0;            ///< for frames without any stamp; 0: the server's
  };

  explicit NatnetInterpreter(const Settings& settings);

  void onPacket(const Packet& packet, PacketSink& sink) override;
  std::vector<std::string> bodies() const override;
  std::string version() const override { return server_ ? text(server_->version) : ""; }

  const std::optional<ServerInfo>& server() const { return server_; }
  /// Of the bit stream, as the server said or as it was set.
  std::optional<Version> bitstream() const { return version_; }
  /// What the session has to know of the last packet.
  std::optional<MessageId> lastMessage() const { return last_message_; }
  bool lastWasFrame() const { return last_frame_ok_; }
  /// Why it could not be understood, or nullptr.
  const char* lastError() const { return last_error_; }

  /// The list of models is not known, has changed, or lacks a body that is streamed.
  bool needsModels() const { return needs_models_; }
  /// Numbers alone say when frames were exposed where neither they nor the file have more: ask for
  /// "FrameRate".
  bool needsRate() const { return settings_.rate_hz == 0.0 && !server_rate_hz_; }
  /// The server sends another bit stream from now on, or seems to: ask which.
  bool bitstreamChanged() const { return bitstream_changed_; }
  /// An answer to our own echo request.
  void addEcho(const EchoResponse& echo, core::Utime received);

 private:
  const char* onServerInfo(Bytes payload, PacketFacts& facts);
  const char* onModels(Bytes payload, PacketFacts& facts);
  const char* onResponse(Bytes payload, PacketFacts& facts);
  const char* onFrame(const Packet& packet, Bytes payload, PacketSink& sink);
  std::optional<core::Utime> exposureOf(core::Utime received);
  const char* misfit(const char* reason, std::optional<std::string_view> fits);
  void restart();
  void fillBodies();
  void fillStamps();

  Settings settings_;
  std::optional<ServerInfo> server_;
  std::optional<Version> version_;
  std::optional<MessageId> last_message_;
  bool last_frame_ok_ = false;
  const char* last_error_ = nullptr;
  std::string misfit_;
  int broken_frames_ = 0;  // in a row
  std::optional<double> server_rate_hz_;
  bool needs_models_ = true;
  bool bitstream_changed_ = false;
  std::map<std::int32_t, std::string> names_;
  ExposureClock clock_;
  Frame frame_;
  SourceFrame out_;
};

}  // namespace roundabout::mocap_bridge::natnet
