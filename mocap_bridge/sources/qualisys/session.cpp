#include "mocap_bridge/sources/qualisys/session.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace roundabout::mocap_bridge::qualisys {

namespace {

constexpr core::Utime kSilence = 2 * core::kMicrosPerSecond;
// A connection that answers no question for so long has lost its other end.
constexpr core::Utime kGiveUp = 3 * core::kMicrosPerSecond;
constexpr core::Utime kAnswerLimit = core::kMicrosPerSecond / 2;
constexpr core::Utime kGreetingLimit = 2 * core::kMicrosPerSecond;

}  // namespace

QualisysSession::QualisysSession(const config::Mocap& mocap)
    : server_(serverOf(mocap, kDefaultPort)), interpreter_(mocap) {}

void QualisysSession::poll(core::Utime now, PacketSink& sink) {
  began_ = began_ == 0 ? now : began_;
  connect(now);
  if (stream_ && stream_->state() == TcpStream::State::kOpen) {
    receive(now, sink);
    answer(interpreter_.takeHeard(), now);
  }
  if (interpreter_.broken()) {
    close(text(server_) +
          " does not speak QTM's real-time protocol here; trying again. Is the port "
          "the little-endian one (22223)?");
  } else if (stream_ && stream_->state() == TcpStream::State::kClosed) {
    close(last_packet_ == 0 ? "" : "the connection to QTM was lost; connecting again");
  } else if (stream_ && phase_ != Phase::kStreaming && now - reconnect_.last > kGreetingLimit) {
    close("");
  } else if (stream_ && now - std::max(last_packet_, reconnect_.last) >= kGiveUp) {
    close("QTM has not answered for 3 s; connecting again");
  }
  noteSilence(now);
}

void QualisysSession::connect(core::Utime now) {
  if (stream_ || !reconnect_.due(now)) {
    return;
  }
  stream_ = std::make_unique<TcpStream>(server_);
  noteConnection();
  if (!stream_->failure().empty()) {
    notes_.once("socket", "no socket for QTM: " + stream_->failure() + "; trying again");
  } else {
    notes_.over("socket");
  }
  enter(Phase::kGreeting, now);
  minor_ = kNewestMinor;
  residuals_ = true;
  stream_asked_ = false;
  state_refused_ = false;
  interpreter_.onConnection();
}

void QualisysSession::close(const std::string& why) {
  if (!why.empty()) {
    notes_.once("lost", why);
  }
  stream_.reset();
  interpreter_.onConnection();
}

void QualisysSession::receive(core::Utime now, PacketSink& sink) {
  for (Bytes bytes = stream_->receive(); !bytes.empty(); bytes = stream_->receive()) {
    const mocap_bridge::Packet packet{arrivalTime(now), server_.port, 0, bytes};
    tapStream(packet);
    interpreter_.onPacket(packet, sink);
    last_packet_ = now;
    notes_.over("no_server");
    if (interpreter_.broken()) {
      return;
    }
  }
}

void QualisysSession::command(const std::string& text) {
  if (stream_) {
    stream_->send(writeText(PacketType::kCommand, text));
  }
}

void QualisysSession::askForNames() {
  stream_asked_ = false;
  command("GetParameters 6D");
}

void QualisysSession::stream() {
  stream_asked_ = true;
  command(residuals_ ? "StreamFrames AllFrames 6DRes" : "StreamFrames AllFrames 6D");
}

void QualisysSession::enter(Phase phase, core::Utime now) {
  phase_ = phase;
  phase_since_ = now;
}

void QualisysSession::onText(const std::string& text, core::Utime now) {
  if (phase_ == Phase::kGreeting) {
    enter(Phase::kVersion, now);
    command(fmt::format("Version 1.{}", minor_));
  } else if (phase_ == Phase::kVersion && text.starts_with("Version set to")) {
    version_ = fmt::format("1.{}", minor_);
    notes_.say(
        fmt::format("connected to QTM at {}, protocol {}", mocap_bridge::text(server_), version_));
    notes_.over("lost");
    // Before any frame: a measurement that is played back says so only when it begins.
    enter(Phase::kState, now);
    command("GetState");
  }
}

void QualisysSession::onError(const std::string& error) {
  if (phase_ == Phase::kVersion) {
    if (--minor_ < kOldestMinor) {
      close(fmt::format("QTM accepts no version from 1.{} to 1.{}: {}", kOldestMinor, kNewestMinor,
                        error));
    } else {
      command(fmt::format("Version 1.{}", minor_));
    }
  } else if (phase_ == Phase::kState) {
    state_refused_ = true;
  } else if (stream_asked_ && residuals_) {
    residuals_ = false;
    notes_.once("residuals", "QTM refuses 6D with residuals, which are done without: " + error);
    stream();
  } else if (stream_asked_) {
    notes_.once("error", "QTM refuses to stream 6D bodies: " + error);
  }
}

// After the version, in this order: state, names, stream. Whatever is not answered is done without.
void QualisysSession::askOn(const QualisysInterpreter::Heard& heard, core::Utime now) {
  const bool enough = !heard.errors.empty() || now - phase_since_ >= kAnswerLimit;
  const bool state = std::any_of(heard.events.begin(), heard.events.end(), isState);
  if (phase_ == Phase::kState && (enough || state)) {
    if (!state) {
      interpreter_.stateUnknown();
      notes_.once("state",
                  "QTM does not say whether it measures or plays a file back: its frames count as "
                  "played back until it does (mocap.accept_recorded: true uses them)");
    }
    enter(Phase::kNames, now);
    askForNames();
  } else if (phase_ == Phase::kNames && (enough || interpreter_.namesKnown())) {
    enter(Phase::kStreaming, now);
    stream();
  }
}

void QualisysSession::askWhatIsDue(core::Utime now) {
  const bool names = !interpreter_.namesKnown() || !interpreter_.namesFit();
  const core::Utime no_data = now - std::max(last_data_, reconnect_.last);
  if (!question_.due(now)) {
    return;
  }
  if (names && names_.due(now)) {
    askForNames();
  } else if (no_data >= core::kMicrosPerSecond && state_.due(now)) {
    // An answer says that the connection is alive.
    if (state_refused_) {
      askForNames();
    } else {
      stream_asked_ = false;
      command("GetState");
    }
  } else if (no_data >= kSilence && restream_.due(now)) {
    stream();
  }
}

void QualisysSession::answer(const QualisysInterpreter::Heard& heard, core::Utime now) {
  for (const std::string& text : heard.texts) {
    onText(text, now);
  }
  for (const std::string& error : heard.errors) {
    onError(error);
  }
  for (const Event event : heard.events) {
    if (event == Event::kCameraSettingsChanged) {
      interpreter_.forgetNames();
    } else if (phase_ == Phase::kStreaming && !heard.data &&
               (event == Event::kCaptureStarted || event == Event::kRtFromFileStarted)) {
      stream();
    }
  }
  if (std::any_of(heard.events.begin(), heard.events.end(), isState)) {
    notes_.over("state", "QTM says what it streams");
  }
  if (heard.data) {
    last_data_ = now;
    stream_asked_ = false;
    notes_.over("no_data", "frames arrive again");
    notes_.over("error");
  }
  askOn(heard, now);
  if (phase_ != Phase::kStreaming) {
    return;
  }
  if (!interpreter_.namesFit()) {
    notes_.once("names",
                "QTM streams another number of bodies than its settings name: names are not "
                "used until they agree (mocap.bodies can name bodies by id, from 0)");
  } else {
    notes_.over("names");
  }
  askWhatIsDue(now);
}

void QualisysSession::noteSilence(core::Utime now) {
  if (now - std::max(began_, last_packet_) >= kSilence && phase_ != Phase::kStreaming) {
    notes_.once(
        "no_server",
        fmt::format("no answer from QTM at {} for 2 s; still trying. Is QTM running, with its "
                    "real-time server on TCP port {} and that open in its firewall? "
                    "(mocap.server; this machine has {})",
                    text(server_), server_.port, interfaceList()));
  } else if (phase_ == Phase::kStreaming &&
             now - std::max(last_data_, reconnect_.last) >= kSilence &&
             now - last_packet_ < kSilence) {
    notes_.once("no_data",
                "QTM answers, but sends no frame: is a measurement or preview running, and "
                "are 6D bodies defined?");
  }
}

void QualisysSession::addDescriptors(std::vector<pollfd>& descriptors) const {
  if (stream_ && stream_->descriptor() >= 0) {
    const short events = stream_->connecting() ? POLLOUT : POLLIN;
    descriptors.push_back({stream_->descriptor(), events, 0});
  }
}

SourceStatus QualisysSession::status() const {
  SourceStatus status;
  status.connected = phase_ == Phase::kStreaming;
  status.server = fmt::format("QTM, protocol {}, at {}", version_, text(server_));
  status.bodies = interpreter_.bodies();
  status.counters = interpreter_.counters();
  return status;
}

}  // namespace roundabout::mocap_bridge::qualisys
