#include "mocap_bridge/sources/qualisys/interpreter.h"

namespace roundabout::mocap_bridge::qualisys {

namespace {

constexpr double kMetres = 0.001;
// A session answers at every poll; who asks nobody need not keep more.
constexpr std::size_t kMostHeard = 256;

template <class Item>
void remember(std::vector<Item>& items, Item item) {
  if (items.size() < kMostHeard) {
    items.push_back(std::move(item));
  }
}

}  // namespace

QualisysInterpreter::QualisysInterpreter(const config::Mocap& mocap) : clock_(mocap.latency_s) {}

void QualisysInterpreter::onConnection() {
  buffer_.clear();
  broken_ = false;
  gap_ = false;
  names_known_ = false;
  from_file_ = false;
  state_unknown_ = false;
  heard_ = {};
  clock_.reset();
}

void QualisysInterpreter::onPacket(const mocap_bridge::Packet& packet, PacketSink& sink) {
  if (broken_) {
    return;
  }
  buffer_.add(packet.payload);
  Bytes stream = buffer_.bytes();
  while (const auto message = takePacket(stream, broken_)) {
    ++counters_.packets;
    onMessage(*message, packet.received, sink);
  }
  if (broken_) {
    ++counters_.malformed;
    sink.onPacket({"packet", "its size cannot be true", {}});
    buffer_.clear();
    broken_ = !gap_;
    return;
  }
  buffer_.keep(stream.size());
}

void QualisysInterpreter::onMessage(const Packet& message, core::Utime received, PacketSink& sink) {
  PacketFacts facts;
  switch (message.type) {
    case PacketType::kData:
      facts.kind = "data";
      facts.error = onData(message.payload, received, sink);
      if (facts.error == nullptr) {
        return;
      }
      break;
    case PacketType::kXml:
      facts.kind = "settings";
      if (auto names = parseBodyNames(message.payload)) {
        names_ = std::move(*names);
        names_known_ = true;
        for (const std::string& name : names_) {
          facts.facts.emplace_back("body", name);
        }
      } else {
        facts.error = "no settings with bodies";
      }
      break;
    case PacketType::kError:
    case PacketType::kCommand: {
      const bool error = message.type == PacketType::kError;
      const std::string text = parseText(message.payload);
      facts.kind = error ? "refusal" : "answer";
      facts.facts = {{"text", text}};
      remember(error ? heard_.errors : heard_.texts, text);
      break;
    }
    case PacketType::kEvent: {
      const auto event = LittleEndianCursor(message.payload).read<std::uint8_t>();
      facts.kind = "event";
      facts.facts = {{"event", std::to_string(event)}};
      onEvent(static_cast<Event>(event));
      break;
    }
    case PacketType::kNoMoreData:
      facts.kind = "no_more_data";
      break;
    default:
      facts.kind = "other";
  }
  counters_.malformed += facts.error != nullptr ? 1 : 0;
  sink.onPacket(facts);
}

void QualisysInterpreter::onEvent(Event event) {
  if (event == Event::kRtFromFileStarted) {
    from_file_ = true;
  } else if (event == Event::kRtFromFileStopped || event == Event::kCaptureStarted) {
    from_file_ = false;
  }
  state_unknown_ = state_unknown_ && !isState(event);
  remember(heard_.events, event);
}

const char* QualisysInterpreter::onData(Bytes payload, core::Utime received, PacketSink& sink) {
  if (const char* reason = parseData(payload, data_)) {
    return reason;
  }
  heard_.data = true;
  if (!data_.has_bodies) {
    return nullptr;
  }
  bool restarted = false;
  // Frame numbers may stand still; the stamps do not.
  if (!admits(static_cast<std::int64_t>(data_.timestamp_us & 0x7fffffffffffffff), restarted,
              false)) {
    return nullptr;
  }
  if (restarted) {
    clock_.reset();
  }
  ExposureClock::Stamps stamps;
  stamps.sent_s = 1e-6 * static_cast<double>(data_.timestamp_us);
  const auto exposure = clock_.exposureOf(stamps, received);
  if (!admits(exposure)) {
    return nullptr;
  }
  ++counters_.frames;
  out_.number = showsEverything() ? data_.frame : ++number_;
  out_.exposure_utime = exposure.value_or(received);
  out_.received_utime = received;
  out_.recorded = from_file_ || state_unknown_;
  out_.stamps = {{"timestamp_us", 0.0, data_.timestamp_us, true}};
  out_.bodies.resize(data_.bodies.size());
  names_fit_ = !names_known_ || names_.size() == data_.bodies.size();
  for (std::size_t i = 0; i < data_.bodies.size(); ++i) {
    const Body& in = data_.bodies[i];
    BodyPose& body = out_.bodies[i];
    body.id = static_cast<std::int64_t>(i);
    body.name = names_known_ && names_fit_ ? names_[i] : "";
    body.position_m = kMetres * Eigen::Vector3d(in.position_mm.data());
    body.orientation = Eigen::Matrix3d(in.rotation.data());
    body.tracked = in.tracked;
    body.residual_m = kMetres * in.residual_mm;
  }
  sink.onFrame(out_);
  return nullptr;
}

}  // namespace roundabout::mocap_bridge::qualisys
