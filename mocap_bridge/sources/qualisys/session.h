#pragma once

#include <memory>

#include "mocap_bridge/sources/qualisys/interpreter.h"
#include "mocap_bridge/sources/session_timer.h"
#include "mocap_bridge/sources/sockets.h"

namespace roundabout::mocap_bridge::qualisys {

/// Talks to QTM: agrees on a version, asks whether it is live and for the bodies' names, streams 6D
/// with residuals (or without, where those are refused), asks again when settings change or a
/// capture begins, and connects again for as long as it runs. One question is open at a time, so
/// that a refusal is known to be of that.
class QualisysSession final : public Source {
 public:
  /// Of `mocap` the server, command port and latency. Throws core::StartupError: unknown host.
  explicit QualisysSession(const config::Mocap& mocap);

  void poll(core::Utime now, PacketSink& sink) override;
  void addDescriptors(std::vector<pollfd>& descriptors) const override;
  SourceStatus status() const override;

 private:
  enum class Phase { kGreeting, kVersion, kState, kNames, kStreaming };

  void receive(core::Utime now, PacketSink& sink);
  void connect(core::Utime now);
  void enter(Phase phase, core::Utime now);
  void askOn(const QualisysInterpreter::Heard& heard, core::Utime now);
  void askWhatIsDue(core::Utime now);
  void answer(const QualisysInterpreter::Heard& heard, core::Utime now);
  void onText(const std::string& text, core::Utime now);
  void onError(const std::string& error);
  void askForNames();
  void stream();
  void command(const std::string& text);
  void close(const std::string& why);
  void noteSilence(core::Utime now);

  Endpoint server_;
  std::unique_ptr<TcpStream> stream_;
  Phase phase_ = Phase::kGreeting;
  int minor_ = kNewestMinor;
  core::Utime phase_since_ = 0;
  bool residuals_ = true;       // of this connection
  bool stream_asked_ = false;   // and neither data nor another question since
  bool state_refused_ = false;  // by this connection
  std::string version_;
  QualisysInterpreter interpreter_;
  SessionTimer reconnect_{core::kMicrosPerSecond};
  SessionTimer names_{core::kMicrosPerSecond};
  SessionTimer restream_{core::kMicrosPerSecond};
  SessionTimer state_{core::kMicrosPerSecond};
  SessionTimer question_{200'000};
  core::Utime began_ = 0;
  core::Utime last_packet_ = 0;
  core::Utime last_data_ = 0;
};

}  // namespace roundabout::mocap_bridge::qualisys
