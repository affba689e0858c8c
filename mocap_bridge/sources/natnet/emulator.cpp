#include "mocap_bridge/sources/natnet/emulator.h"

#include "common/core/error.h"
#include "mocap_bridge/sources/natnet/parser.h"
#include "mocap_bridge/sources/natnet/writer.h"

namespace roundabout::mocap_bridge::natnet {

namespace {

constexpr std::uint64_t kTickFrequency_hz = 10'000'000;
constexpr core::Utime kClientTimeout = 4 * core::kMicrosPerSecond;

std::uint64_t ticksOf(core::Utime utime) { return static_cast<std::uint64_t>(utime) * 10; }

ServerInfo infoOf(const EmulatorSettings& settings) {
  ServerInfo info;
  info.name = "Motive";
  const auto version = parseVersion(settings.version.empty() ? "3.1" : settings.version);
  if (!version || *version < Version{2, 5} || *version > kNewestKnown) {
    throw core::StartupError("mocap emulate", "--version", "2.5 to " + text(kNewestKnown),
                             "\"" + settings.version + "\"");
  }
  info.version = *version;
  info.application_version = {2, 3, 0, 0};
  info.tick_frequency_hz = kTickFrequency_hz;
  info.data_port =
      settings.data_port == 0 ? kDefaultDataPort : static_cast<std::uint16_t>(settings.data_port);
  info.multicast = settings.transport == "multicast";
  info.group = settings.group.empty() ? kDefaultGroup : resolveAddress("--group", settings.group);
  return info;
}

}  // namespace

NatnetEmulator::NatnetEmulator(const EmulatorSettings& settings)
    : info_(infoOf(settings)),
      bitstream_(info_.version),
      rate_hz_(settings.rate_hz),
      command_("NatNet command port",
               {resolveAddress("--address", settings.address),
                settings.command_port == 0 ? kDefaultCommandPort
                                           : static_cast<std::uint16_t>(settings.command_port)}),
      data_("NatNet data port", {resolveAddress("--address", settings.address), 0}) {
  data_.sendThrough(resolveAddress("--address", settings.address));
}

void NatnetEmulator::addDescriptors(std::vector<pollfd>& descriptors) const {
  descriptors.push_back({command_.descriptor(), POLLIN, 0});
}

void NatnetEmulator::poll(core::Utime now) {
  while (const auto request = command_.receive()) {
    answer(*request, now);
  }
  std::erase_if(clients_, [&](const auto& client) { return now - client.second > kClientTimeout; });
}

void NatnetEmulator::answer(const UdpSocket::Received& request, core::Utime now) {
  const auto message = parseMessage(request.payload);
  if (!message) {
    return;
  }
  const auto client = std::make_pair(request.from.address, request.from.port);
  LittleEndianCursor cursor(message->payload);
  switch (message->id) {
    case MessageId::kConnect:
      clients_[client] = now;
      command_.send(request.from, writeServerInfo(info_));
      break;
    case MessageId::kDiscovery:
      command_.send(request.from, writeServerInfo(info_));
      break;
    case MessageId::kKeepAlive:
      if (const auto known = clients_.find(client); known != clients_.end()) {
        known->second = now;
      }
      break;
    case MessageId::kDisconnect:
      clients_.erase(client);
      break;
    case MessageId::kRequestModelDef:
      command_.send(request.from, writeModelDef(models_, bitstream_));
      break;
    case MessageId::kEchoRequest:
      command_.send(request.from, writeEchoResponse({cursor.read<std::uint64_t>(), ticksOf(now)}));
      break;
    case MessageId::kRequest:
      answerText(request.from, cursor.readText());
      break;
    default:
      command_.send(request.from, writeMessage(MessageId::kUnrecognizedRequest));
  }
}

void NatnetEmulator::answerText(const Endpoint& client, std::string_view text) {
  LittleEndianWriter number;
  if (text == "FrameRate") {
    number.put(static_cast<float>(rate_hz_));
    command_.send(client, writeMessage(MessageId::kResponse, number.bytes()));
  } else if (text == "AnalogSamplesPerMocapFrame") {
    number.put<std::int32_t>(0);
    command_.send(client, writeMessage(MessageId::kResponse, number.bytes()));
  } else if (text == "Bitstream") {
    command_.send(
        client, writeText(MessageId::kResponse, "Bitstream," + natnet::text(bitstream_) + ".0.0"));
  } else {
    command_.send(client, writeMessage(MessageId::kUnrecognizedRequest));
  }
}

void NatnetEmulator::learnModels(const SourceFrame& frame) {
  bool same = models_.bodies.size() == frame.bodies.size();
  for (std::size_t i = 0; same && i < frame.bodies.size(); ++i) {
    same = models_.bodies[i].id == frame.bodies[i].id &&
           models_.bodies[i].name == frame.bodies[i].name;
  }
  models_changed_ = !same;
  if (!same) {
    models_.bodies.clear();
    for (const BodyPose& body : frame.bodies) {
      models_.bodies.push_back({static_cast<std::int32_t>(body.id), body.name});
    }
  }
}

void NatnetEmulator::send(const SourceFrame& frame, core::Utime now) {
  learnModels(frame);
  frame_.number = static_cast<std::int32_t>(frame.number);
  frame_.bodies.resize(frame.bodies.size());
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const BodyPose& in = frame.bodies[i];
    RigidBody& out = frame_.bodies[i];
    out.id = static_cast<std::int32_t>(in.id);
    Eigen::Map<Eigen::Vector3f>(out.position.data()) = in.position_m.cast<float>();
    Eigen::Map<Eigen::Vector4f>(out.orientation_xyzw.data()) =
        in.orientation.coeffs().cast<float>();
    out.mean_error_m = 0.0005F;
    out.tracked = in.tracked;
  }
  frame_.timestamp_s = core::toSeconds(frame.exposure_utime);
  frame_.software_latency_s = static_cast<float>(frame_.timestamp_s);
  frame_.mid_exposure_ticks = ticksOf(frame.exposure_utime);
  frame_.data_received_ticks = frame_.mid_exposure_ticks;
  frame_.transmit_ticks = ticksOf(now);
  frame_.params = static_cast<std::uint16_t>((frame.recorded ? Frame::kEditMode : 0) |
                                             (models_changed_ ? Frame::kModelListChanged : 0));
  const Datagram datagram = writeFrame(frame_, bitstream_);
  if (info_.multicast) {
    data_.send({info_.group, info_.data_port}, datagram);
    return;
  }
  for (const auto& [client, heard] : clients_) {
    command_.send({client.first, client.second}, datagram);
  }
}

}  // namespace roundabout::mocap_bridge::natnet
