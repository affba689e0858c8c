#include "mocap_bridge/sources/natnet/interpreter.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::mocap_bridge::natnet {

namespace {

// So many frames in a row that are not what the version says are of another bit stream.
constexpr int kManyBroken = 10;
// Half of it is what an echo may be wrong by. A laboratory's network takes a millisecond; longer
// ones waited in a process that stood still.
constexpr std::uint64_t kLongestRoundTrip = 20'000;

std::string dotted(const std::array<std::uint8_t, 4>& version) {
  return fmt::format("{}.{}.{}.{}", version[0], version[1], version[2], version[3]);
}

const char* nameOf(MessageId id) {
  switch (id) {
    case MessageId::kConnect:
      return "connect";
    case MessageId::kServerInfo:
      return "server_info";
    case MessageId::kRequest:
      return "request";
    case MessageId::kResponse:
      return "response";
    case MessageId::kRequestModelDef:
      return "request_model_def";
    case MessageId::kModelDef:
      return "model_def";
    case MessageId::kRequestFrame:
      return "request_frame";
    case MessageId::kFrame:
      return "frame";
    case MessageId::kMessageString:
      return "message_string";
    case MessageId::kDisconnect:
      return "disconnect";
    case MessageId::kKeepAlive:
      return "keep_alive";
    case MessageId::kDisconnectByTimeout:
      return "disconnect_by_timeout";
    case MessageId::kEchoRequest:
      return "echo_request";
    case MessageId::kEchoResponse:
      return "echo_response";
    case MessageId::kDiscovery:
      return "discovery";
    case MessageId::kUnrecognizedRequest:
      return "unrecognized_request";
  }
  return "unknown";
}

std::string textOf(Bytes payload) {
  return std::string(LittleEndianCursor(payload).readText(payload.size()));
}

}  // namespace

NatnetInterpreter::NatnetInterpreter(const Settings& settings)
    : settings_(settings), version_(settings.version), clock_(settings.latency_s) {}

std::vector<std::string> NatnetInterpreter::bodies() const {
  std::vector<std::string> bodies;
  for (const auto& [id, name] : names_) {
    bodies.push_back(config::bodyText(name, id));
  }
  return bodies;
}

void NatnetInterpreter::onPacket(const Packet& packet, PacketSink& sink) {
  ++counters_.packets;
  last_message_.reset();
  last_frame_ok_ = false;
  last_error_ = nullptr;
  PacketFacts facts;
  const auto message = parseMessage(packet.payload);
  if (!message) {
    facts.error = "shorter than a header";
  } else {
    last_message_ = message->id;
    facts.kind = nameOf(message->id);
    EchoResponse echo;
    switch (message->id) {
      case MessageId::kServerInfo:
        facts.error = onServerInfo(message->payload, facts);
        break;
      case MessageId::kModelDef:
        facts.error = onModels(message->payload, facts);
        break;
      case MessageId::kFrame:
        facts.error = onFrame(packet, message->payload, sink);
        if (facts.error == nullptr) {
          return;
        }
        break;
      case MessageId::kResponse:
        facts.error = onResponse(message->payload, facts);
        break;
      case MessageId::kEchoResponse:
        facts.error = parseEchoResponse(message->payload, echo);
        facts.facts = {{"client_stamp", std::to_string(echo.client_stamp)},
                       {"server_ticks", std::to_string(echo.server_ticks)}};
        break;
      case MessageId::kRequest:
      case MessageId::kMessageString:
        facts.facts = {{"text", textOf(message->payload)}};
        break;
      default:
        break;
    }
  }
  last_error_ = facts.error;
  counters_.malformed += facts.error != nullptr ? 1 : 0;
  sink.onPacket(facts);
}

const char* NatnetInterpreter::onServerInfo(Bytes payload, PacketFacts& facts) {
  ServerInfo info;
  if (const char* reason = parseServerInfo(payload, info)) {
    return reason;
  }
  const bool another = !server_ || server_->version != info.version ||
                       server_->tick_frequency_hz != info.tick_frequency_hz;
  if (another) {
    restart();
  }
  if (another || broken_frames_ >= kManyBroken) {
    version_ = info.version;
  }
  server_ = info;
  facts.facts = {{"application", info.name + " " + dotted(info.application_version)},
                 {"version", text(info.version)}};
  if (info.version.major >= 3) {
    facts.facts.emplace_back("tick_frequency_hz", std::to_string(info.tick_frequency_hz));
    facts.facts.emplace_back("data_port", std::to_string(info.data_port));
    facts.facts.emplace_back("transport", info.multicast ? "multicast" : "unicast");
  }
  return nullptr;
}

// The server, or the numbers of its frames, began anew.
void NatnetInterpreter::restart() {
  clock_.reset();
  needs_models_ = true;
  server_rate_hz_.reset();
}

const char* NatnetInterpreter::onModels(Bytes payload, PacketFacts& facts) {
  if (!version_) {
    return "no server has said its version yet, and none was given";
  }
  ModelDef definitions;
  const char* reason = parseModelDef(payload, *version_, definitions);
  if (reason != nullptr && showsEverything()) {
    reason = misfit(reason, onlyModelDefLayoutOf(payload));
  }
  if (reason != nullptr && definitions.bodies.empty()) {
    return reason;  // names that were read before something unknown are good
  }
  names_.clear();
  for (ModelDef::Body& body : definitions.bodies) {
    facts.facts.emplace_back("definition", fmt::format("{} {}", body.id, body.name));
    names_[body.id] = std::move(body.name);
  }
  needs_models_ = false;
  return reason;
}

// What to do about a packet that is not of the version it was read as.
const char* NatnetInterpreter::misfit(const char* reason, std::optional<std::string_view> fits) {
  misfit_ = fmt::format("{}, read as NatNet {}", reason, text(*version_));
  if (fits) {
    misfit_ += fmt::format("; as one of NatNet {} it would be whole", *fits);
  }
  return misfit_.c_str();
}

const char* NatnetInterpreter::onResponse(Bytes payload, PacketFacts& facts) {
  if (const auto version = parseBitstream(payload)) {
    version_ = version;
    bitstream_changed_ = false;
    broken_frames_ = 0;
    facts.facts = {{"bitstream", text(*version)}};
  } else if (const auto value = parseFloatResponse(payload)) {
    if (*value >= 1.0F && *value <= 2000.0F) {
      server_rate_hz_ = static_cast<double>(*value);  // the answer to "FrameRate"
    }
    facts.facts = {{"as_float", fmt::format("{}", *value)}};
  } else {
    facts.facts = {{"text", textOf(payload)}};
  }
  return nullptr;
}

void NatnetInterpreter::addEcho(const EchoResponse& echo, core::Utime received) {
  const auto now = static_cast<std::uint64_t>(received);
  const std::uint64_t round_trip_us = now - echo.client_stamp;
  if (!server_ || server_->tick_frequency_hz == 0 || echo.client_stamp > now ||
      round_trip_us > kLongestRoundTrip) {
    return;  // of a question that nobody remembers, or that waited for an answer
  }
  const auto round_trip = static_cast<core::Utime>(round_trip_us);
  const double remote_s =
      static_cast<double>(echo.server_ticks) / static_cast<double>(server_->tick_frequency_hz);
  clock_.addEcho(remote_s, received - round_trip / 2, core::toSeconds(round_trip));
}

const char* NatnetInterpreter::onFrame(const Packet& packet, Bytes payload, PacketSink& sink) {
  if (!version_) {
    return "no server has said its version yet, and none was given";
  }
  if (const char* reason = parseFrame(payload, *version_, frame_)) {
    broken_frames_ = std::min(broken_frames_ + 1, kManyBroken);
    bitstream_changed_ = bitstream_changed_ || broken_frames_ == kManyBroken;
    return showsEverything() ? misfit(reason, onlyFrameLayoutOf(payload)) : reason;
  }
  broken_frames_ = 0;
  bool restarted = false;
  if (!admits(frame_.number, restarted)) {
    return nullptr;
  }
  if (restarted) {
    restart();
  }
  last_frame_ok_ = true;
  needs_models_ = needs_models_ || frame_.has(Frame::kModelListChanged);
  bitstream_changed_ = bitstream_changed_ || frame_.has(Frame::kBitstreamChanged);
  const auto exposure = exposureOf(packet.received);
  if (!admits(exposure)) {
    return nullptr;
  }
  ++counters_.frames;
  out_.number = frame_.number;
  out_.exposure_utime = exposure.value_or(packet.received);
  out_.received_utime = packet.received;
  out_.recorded = frame_.has(Frame::kEditMode);
  fillStamps();
  fillBodies();
  sink.onFrame(out_);
  return nullptr;
}

std::optional<core::Utime> NatnetInterpreter::exposureOf(core::Utime received) {
  ExposureClock::Stamps stamps;
  const double frequency_hz = server_ ? static_cast<double>(server_->tick_frequency_hz) : 0.0;
  if (frequency_hz > 0.0 && frame_.transmit_ticks > 0) {
    stamps.sent_s = static_cast<double>(frame_.transmit_ticks) / frequency_hz;
    if (frame_.mid_exposure_ticks > 0) {
      stamps.exposure_s = static_cast<double>(frame_.mid_exposure_ticks) / frequency_hz;
    }
  } else if (std::isfinite(frame_.timestamp_s)) {
    stamps.sent_s = frame_.timestamp_s;
  } else if (const double rate_hz =
                 settings_.rate_hz > 0.0 ? settings_.rate_hz : server_rate_hz_.value_or(0.0);
             rate_hz > 0.0) {
    stamps.sent_s = static_cast<double>(frame_.number) / rate_hz;
  }
  return clock_.exposureOf(stamps, received);
}

void NatnetInterpreter::fillStamps() {
  out_.stamps.clear();
  if (std::isfinite(frame_.timestamp_s)) {
    out_.stamps.push_back({"timestamp_s", frame_.timestamp_s});
  }
  if (*version_ < Version{3, 0}) {
    out_.stamps.push_back({"software_latency_s", static_cast<double>(frame_.software_latency_s)});
  } else {
    out_.stamps.push_back({"mid_exposure_ticks", 0.0, frame_.mid_exposure_ticks, true});
    out_.stamps.push_back({"data_received_ticks", 0.0, frame_.data_received_ticks, true});
    out_.stamps.push_back({"transmit_ticks", 0.0, frame_.transmit_ticks, true});
  }
  if (*version_ >= Version{4, 1}) {
    out_.stamps.push_back({"precision_s", 0.0, frame_.precision_s, true});
    out_.stamps.push_back({"precision_fraction", 0.0, frame_.precision_fraction, true});
  }
}

void NatnetInterpreter::fillBodies() {
  out_.bodies.resize(frame_.bodies.size());
  for (std::size_t i = 0; i < frame_.bodies.size(); ++i) {
    const RigidBody& in = frame_.bodies[i];
    BodyPose& out = out_.bodies[i];
    const auto name = names_.find(in.id);
    if (name == names_.end()) {
      needs_models_ = true;
      out.name.clear();
    } else {
      out.name = name->second;
    }
    out.id = in.id;
    out.position_m = Eigen::Vector3f(in.position.data()).cast<double>();
    out.orientation = Eigen::Quaternionf(in.orientation_xyzw.data()).cast<double>();
    out.tracked = in.tracked;
    out.residual_m = static_cast<double>(in.mean_error_m);
  }
}

}  // namespace roundabout::mocap_bridge::natnet
