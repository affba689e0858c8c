#include "mocap_bridge/sources/vrpn/interpreter.h"

#include <algorithm>

namespace roundabout::mocap_bridge::vrpn {

namespace {

// Ids come off the wire: nobody can make us remember more.
constexpr std::size_t kMostNames = 4096;
// Stamps of one frame's bodies follow each other within this: some servers stamp each as they send
// it. Cameras at 1 kHz are the fastest.
constexpr core::Utime kTogether = 1'000;

double secondsOf(std::int64_t stamp_us) { return core::toSeconds(stamp_us); }

}  // namespace

VrpnInterpreter::VrpnInterpreter(const config::Mocap& mocap) : clock_(mocap.latency_s) {}

std::vector<std::string> VrpnInterpreter::bodies() const {
  std::vector<std::string> names;
  for (const auto& [id, name] : senders_) {
    if (name != "VRPN Control") {
      names.push_back(name);
    }
  }
  return names;
}

void VrpnInterpreter::onConnection() {
  buffer_.clear();
  greeted_ = false;
  broken_ = false;
  gap_ = false;
  senders_.clear();
  types_.clear();
  clock_.reset();
  assembler_ = FrameAssembler();
  stamps_us_.clear();
  frame_stamp_us_ = 0;
  last_stamp_us_ = 0;
}

void VrpnInterpreter::fail(const char* kind, const char* reason, PacketSink& sink) {
  ++counters_.malformed;
  sink.onPacket({kind, reason, {}});
}

void VrpnInterpreter::onPacket(const Packet& packet, PacketSink& sink) {
  if (broken_) {
    return;
  }
  buffer_.add(packet.payload);
  Bytes stream = buffer_.bytes();
  if (!greeted_ && !readCookie(stream, sink)) {
    return;
  }
  while (const auto message = takeMessage(stream, broken_)) {
    ++counters_.packets;
    onMessage(*message, packet.received, sink);
  }
  if (broken_) {
    fail("message", "its length cannot be true", sink);
    buffer_.clear();
    broken_ = !gap_;
    return;
  }
  buffer_.keep(stream.size());
}

bool VrpnInterpreter::readCookie(Bytes& stream, PacketSink& sink) {
  if (stream.size() < kCookieBytes) {
    return false;
  }
  const Bytes cookie = stream.first(kCookieBytes);
  if (!goodCookie(cookie)) {
    broken_ = true;
    buffer_.clear();
    fail("cookie", "not of VRPN 7", sink);
    return false;
  }
  greeted_ = true;
  greeting_ = std::string(BigEndianCursor(cookie).readText(kCookieBytes));
  stream = stream.subspan(kCookieBytes);
  sink.onPacket({"cookie", nullptr, {{"text", greeting_}}});
  return true;
}

void VrpnInterpreter::onMessage(const Message& message, core::Utime received, PacketSink& sink) {
  if (message.type == kSenderDescription || message.type == kTypeDescription) {
    const bool sender = message.type == kSenderDescription;
    const char* kind = sender ? "sender" : "type";
    auto& names = sender ? senders_ : types_;
    const auto name = parseDescription(message.payload);
    if (!name) {
      fail(kind, "a description without a name", sink);
    } else if (names.size() < kMostNames || names.contains(message.sender)) {
      names[message.sender] = *name;
      sink.onPacket({kind, nullptr, {{"id", std::to_string(message.sender)}, {"name", *name}}});
    }
    return;
  }
  const auto type = types_.find(message.type);
  if (message.type >= 0 && type != types_.end() && type->second == kPoseType) {
    onPose(message, received, sink);
  } else {
    sink.onPacket(
        {"message",
         nullptr,
         {{"type_name", type == types_.end() ? std::to_string(message.type) : type->second}}});
  }
}

// A tracker's first sensor has the tracker's name, a further one that name and its number.
std::string VrpnInterpreter::bodyName(const Message& message, std::int32_t sensor) const {
  const auto sender = senders_.find(message.sender);
  const std::string name =
      sender == senders_.end() ? "sender " + std::to_string(message.sender) : sender->second;
  return sensor == 0 ? name : name + ":" + std::to_string(sensor);
}

bool VrpnInterpreter::has(const std::string& body) const {
  return std::any_of(assembler_.frame().bodies.begin(), assembler_.frame().bodies.end(),
                     [&](const BodyPose& other) { return other.name == body; });
}

// A body's second pose is another frame's, however soon it comes, unless it is the same pose again.
bool VrpnInterpreter::joins(std::int64_t stamp_us, const std::string& body) const {
  const auto own = stamps_us_.find(body);
  return own == stamps_us_.end() ? std::abs(stamp_us - last_stamp_us_) <= kTogether
                                 : own->second == stamp_us;
}

void VrpnInterpreter::onPose(const Message& message, core::Utime received, PacketSink& sink) {
  Pose pose;
  if (const char* reason = parsePose(message.payload, pose)) {
    fail("pose", reason, sink);
    return;
  }
  const std::int64_t stamp_us =
      std::int64_t{message.seconds} * core::kMicrosPerSecond + message.microseconds;
  const std::string name = bodyName(message, pose.sensor);
  if (!joins(stamp_us, name)) {
    frame_stamp_us_ = stamp_us;
    stamps_us_.clear();
  }
  if (stamps_us_.size() < kMostNames) {
    stamps_us_[name] = stamp_us;
  }
  last_stamp_us_ = stamp_us;
  const auto unsent = assembler_.begin(frame_stamp_us_);
  if (unsent && !showsEverything()) {
    emit(*unsent, sink);
  }
  SourceFrame& frame = assembler_.frame();
  if (frame.bodies.empty()) {
    frame.number = ++number_;
    frame.received_utime = received;
    frame.stamps = {{"stamp_s", secondsOf(stamp_us)}};
  }
  BodyPose body;
  body.name = name;
  body.position_m = Eigen::Vector3d(pose.position_m.data());
  body.orientation = Eigen::Quaterniond(pose.orientation_xyzw.data());
  body.tracked = true;
  if (ids_.size() < kMostNames) {
    body.id = ids_.try_emplace(body.name, static_cast<std::int64_t>(ids_.size())).first->second;
  }
  if (showsEverything()) {
    SourceFrame single = frame;
    single.stamps = {{"stamp_s", secondsOf(stamp_us)}};
    single.bodies = {body};
    sink.onFrame(single);
    return;
  }
  if (has(name) || frame.bodies.size() >= kMostNames) {
    ++counters_.old_frames;
    return;
  }
  frame.bodies.push_back(std::move(body));
  if (assembler_.complete()) {
    emit(frame, sink);
  }
}

void VrpnInterpreter::emit(const SourceFrame& frame, PacketSink& sink) {
  const double stamp_s = frame.stamps.front().seconds;
  bool restarted = false;
  if (!admits(core::toUtime(stamp_s), restarted, false)) {
    return;
  }
  if (restarted) {
    clock_.reset();
  }
  ExposureClock::Stamps stamps;
  stamps.sent_s = stamp_s;
  const auto exposure = clock_.exposureOf(stamps, frame.received_utime);
  if (!admits(exposure)) {
    return;
  }
  ++counters_.frames;
  SourceFrame out = frame;
  out.exposure_utime = *exposure;
  sink.onFrame(out);
}

}  // namespace roundabout::mocap_bridge::vrpn
