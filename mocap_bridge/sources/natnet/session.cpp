#include "mocap_bridge/sources/natnet/session.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "mocap_bridge/sources/natnet/writer.h"

namespace roundabout::mocap_bridge::natnet {

namespace {

constexpr core::Utime kSilence = 2 * core::kMicrosPerSecond;
constexpr std::uint32_t kBroadcast = 0xffffffff;
constexpr const char* kClientName = "roundabout";

std::uint32_t serverAddress(const config::Mocap& settings) {
  return settings.server.empty() ? kBroadcast : resolveAddress("mocap.server", settings.server);
}

std::uint16_t orDefault(int port, std::uint16_t otherwise) {
  return port == 0 ? otherwise : static_cast<std::uint16_t>(port);
}

NatnetInterpreter::Settings interpreterSettings(const config::Mocap& settings) {
  return {std::nullopt, settings.latency_s, settings.rate_hz};
}

}  // namespace

NatnetSession::NatnetSession(const config::Mocap& mocap)
    : settings_(mocap),
      server_{serverAddress(mocap), orDefault(mocap.command_port, kDefaultCommandPort)},
      interface_(interfaceAddress("mocap.interface", mocap.interface)),
      searching_(mocap.server.empty()),
      command_("NatNet command socket", {interface_, 0}),
      interpreter_(interpreterSettings(mocap)) {
  if (!mocap.group.empty() && !isMulticast(resolveAddress("mocap.group", mocap.group))) {
    throw core::StartupError("mocap", "group", "an address from 224.0.0.0 to 239.255.255.255",
                             mocap.group);
  }
}

void NatnetSession::poll(core::Utime now, PacketSink& sink) {
  if (began_ == 0) {
    began_ = now;
  }
  receive(command_, now, sink);
  if (data_) {
    receive(*data_, now, sink);
  }
  sendWhatIsDue(now);
  noteSilence(now);
}

void NatnetSession::addDescriptors(std::vector<pollfd>& descriptors) const {
  descriptors.push_back({command_.descriptor(), POLLIN, 0});
  if (data_) {
    descriptors.push_back({data_->descriptor(), POLLIN, 0});
  }
}

SourceStatus NatnetSession::status() const {
  SourceStatus status;
  status.counters = interpreter_.counters();
  status.counters.wrong_sender = wrong_sender_;
  status.bodies = interpreter_.bodies();
  status.connected = connected_;
  if (const auto& server = interpreter_.server()) {
    const auto& version = server->application_version;
    status.server =
        fmt::format("{} {}.{}.{}, NatNet {}, at {}", server->name, version[0], version[1],
                    version[2], text(server->version), addressText(server_.address));
  }
  return status;
}

void NatnetSession::receive(UdpSocket& socket, core::Utime now, PacketSink& sink) {
  // What arrives while we work is for the next call: nobody can keep us here.
  constexpr int kMost = 256;
  const std::uint16_t port = socket.port();
  for (int i = 0; i < kMost; ++i) {
    const auto datagram = socket.receive();
    if (!datagram) {
      return;
    }
    onDatagram(*datagram, port, arrivalTime(now), sink);
  }
}

void NatnetSession::onDatagram(const UdpSocket::Received& datagram, std::uint16_t to_port,
                               core::Utime now, PacketSink& sink) {
  if (searching_ && findsServer(datagram)) {
    searching_ = false;
    server_.address = datagram.from.address;
    notes_.say("found a NatNet server at " + text(server_));
  }
  if (datagram.from.address != server_.address) {
    ++wrong_sender_;
    if (searching_) {
      return;
    }
    notes_.once("wrong_sender",
                fmt::format("NatNet packets from {} are not looked at: the server "
                            "is {} (mocap.server)",
                            addressText(datagram.from.address), addressText(server_.address)));
    return;
  }
  const Packet packet{now, datagram.from.port, to_port, datagram.payload};
  if (tap_) {
    tap_(packet);
  }
  const std::int64_t malformed = interpreter_.counters().malformed;
  const std::int64_t restarts = interpreter_.counters().restarts;
  interpreter_.onPacket(packet, sink);
  if (interpreter_.counters().malformed > malformed) {
    onBroken(now);
    return;
  }
  if (interpreter_.counters().restarts > restarts) {
    noteRestart(now);
  }
  EchoResponse echo;
  if (interpreter_.lastWasFrame()) {
    last_frame_ = now;
  } else if (interpreter_.lastMessage() == MessageId::kServerInfo) {
    onServerInfo(now);
  } else if (interpreter_.lastMessage() == MessageId::kEchoResponse &&
             parseEchoResponse(parseMessage(datagram.payload)->payload, echo) == nullptr) {
    noteAnswer(now);
    interpreter_.addEcho(echo, now);
  } else if (interpreter_.lastMessage() == MessageId::kDisconnectByTimeout) {
    connect();
  }
}

bool NatnetSession::findsServer(const UdpSocket::Received& datagram) {
  const auto message = parseMessage(datagram.payload);
  ServerInfo info;
  return message && message->id == MessageId::kServerInfo &&
         parseServerInfo(message->payload, info) == nullptr;
}

void NatnetSession::onBroken(core::Utime now) {
  if (interpreter_.lastMessage() != MessageId::kFrame) {
    notes_.once("malformed", "a NatNet packet could not be understood; further ones are counted");
    return;
  }
  last_broken_frame_ = now;
  notes_.once("broken_frame",
              fmt::format("a frame could not be understood as one of NatNet {}: {}; further ones "
                          "are counted",
                          interpreter_.bitstream() ? text(*interpreter_.bitstream()) : "?",
                          interpreter_.lastError()));
}

void NatnetSession::noteRestart(core::Utime now) {
  constexpr core::Utime kWhile = 10 * core::kMicrosPerSecond;
  constexpr int kMany = 3;
  restarts_lately_ = now - last_restart_ < kWhile ? restarts_lately_ + 1 : 1;
  last_restart_ = now;
  if (restarts_lately_ < kMany) {
    notes_.over("two_servers");
    notes_.say("Motive's frame numbers began anew");
  } else {
    notes_.once("two_servers",
                "Motive's frame numbers keep jumping back and forth: do two servers send by " +
                    where() + "? Further jumps are counted");
  }
}

void NatnetSession::noteAnswer(core::Utime now) {
  if (now - last_answer_ >= kSilence) {
    answering_since_ = now;
  }
  last_answer_ = now;
}

void NatnetSession::onServerInfo(core::Utime now) {
  const bool first = last_answer_ == 0;
  noteAnswer(now);
  if (first) {
    notes_.say("connected to " + status().server);
  }
  notes_.over("no_server");
  openDataSocket(now);
  if (interpreter_.bitstream() > kNewestKnown) {
    if (multicast()) {
      notes_.once("newer",
                  fmt::format("NatNet {} is newer than what is known here ({}); bodies are "
                              "read as far as sizes allow",
                              text(*interpreter_.bitstream()), text(kNewestKnown)));
    } else {
      send(writeText(MessageId::kRequest, "Bitstream,4.1"));
      send(writeText(MessageId::kRequest, "Bitstream"));
    }
  }
}

bool NatnetSession::multicast() const {
  const auto& server = interpreter_.server();
  return settings_.transport == "multicast" ||
         (settings_.transport == "auto" && (!server || server->multicast));
}

std::uint32_t NatnetSession::group() const {
  if (!settings_.group.empty()) {
    return resolveAddress("mocap.group", settings_.group);
  }
  const auto& server = interpreter_.server();
  return server && isMulticast(server->group) ? server->group : kDefaultGroup;
}

std::uint16_t NatnetSession::dataPort() const {
  const auto& server = interpreter_.server();
  return orDefault(settings_.data_port, server ? server->data_port : kDefaultDataPort);
}

std::string NatnetSession::where() const {
  return multicast()
             ? fmt::format(
                   "multicast {}:{} on interface {}", addressText(group()), dataPort(),
                   interface_ == kAnyAddress ? "that routes choose" : addressText(interface_))
             : fmt::format("unicast to ports {} and {}", command_.port(), dataPort());
}

void NatnetSession::openDataSocket(core::Utime now) {
  const Endpoint at{multicast() ? group() : kAnyAddress, dataPort()};
  if (data_ && at == data_at_) {
    return;
  }
  data_opened_ = now;
  try {
    // Bound to the group, the socket hears nothing that is sent to this machine or other groups.
    auto socket = std::make_unique<UdpSocket>("NatNet data socket", at);
    if (multicast()) {
      socket->joinGroup(at.address, interface_);
    }
    data_ = std::move(socket);
    data_at_ = at;
    notes_.over("data_socket");
  } catch (const core::StartupError& error) {
    notes_.once("data_socket", error.what());
  }
}

void NatnetSession::connect() {
  const auto& server = interpreter_.server();
  if (searching_) {
    command_.send(server_, writeMessage(MessageId::kDiscovery));
  } else if (server && server->version >= Version{4, 0}) {
    const Version wanted = server->version > kNewestKnown ? Version{4, 1} : Version{0, 0};
    send(writeConnect(kClientName, kNewestKnown, wanted));
  } else {
    send(writeConnect(kClientName, kNewestKnown));
  }
}

void NatnetSession::sendWhatIsDue(core::Utime now) {
  const bool answered = last_answer_ != 0;
  const bool silent = now - std::max(last_frame_, last_answer_) >= kSilence;
  const bool no_frames = now - last_frame_ >= kSilence;
  if ((!answered || silent || no_frames) && connect_.due(now)) {
    connect();
  }
  if (!answered) {
    return;
  }
  if (interpreter_.server()->tick_frequency_hz > 0 && echo_.due(now)) {
    send(writeEchoRequest(static_cast<std::uint64_t>(now)));
  }
  if (!multicast() && keep_alive_.due(now)) {
    send(writeMessage(MessageId::kKeepAlive));
  }
  if (now - std::max({last_frame_, last_broken_frame_, data_opened_}) >= kSilence) {
    data_.reset();  // a network card that came back has left the group
    openDataSocket(now);
  }
  if (interpreter_.needsRate() && rate_.due(now)) {
    send(writeText(MessageId::kRequest, "FrameRate"));
  }
  if (interpreter_.needsModels() && models_.due(now)) {
    send(writeMessage(MessageId::kRequestModelDef));
  }
  if (interpreter_.bitstreamChanged() && bitstream_.due(now)) {
    connect();
    send(writeText(MessageId::kRequest, "Bitstream"));
  }
}

void NatnetSession::noteSilence(core::Utime now) {
  if (last_answer_ == 0) {
    if (now - began_ >= kSilence) {
      notes_.once(
          "no_server",
          fmt::format(
              "no answer from Motive at {} for 2 s; still trying. Is it running with Broadcast "
              "Frame Data on, its Local Interface on this network, UDP port {} open in its "
              "firewall? (mocap.server, mocap.interface; this machine has {})",
              searching_ ? "any address (broadcast)" : text(server_), server_.port,
              interfaceList()));
    }
    return;
  }
  const core::Utime last = std::max(last_frame_, last_answer_);
  connected_ = now - last < kSilence;
  if (!connected_) {
    notes_.once("silent",
                fmt::format("Motive at {} has fallen silent; still trying", text(server_)));
    if (settings_.server.empty()) {
      searching_ = true;
      server_.address = kBroadcast;
    }
    return;
  }
  notes_.over("silent", "Motive is back");
  if (now - last_frame_ < kSilence) {
    notes_.over("no_frames", "frames are back");
    notes_.over("no_good_frames", "frames are understood again");
  } else if (now - last_broken_frame_ < kSilence) {
    notes_.once("no_good_frames",
                fmt::format("frames arrive by {}, but none can be understood as one of NatNet {}: "
                            "which bit stream does Motive send? Asking it",
                            where(), text(*interpreter_.bitstream())));
  } else if (now - answering_since_ >= kSilence) {
    notes_.once(
        "no_frames",
        fmt::format("Motive answers, but no frame arrives by {}. Set mocap.interface to the "
                    "address of the network card at Motive (this machine has {}), and in Motive "
                    "Broadcast Frame Data, Rigid Bodies and the transmission type",
                    where(), interfaceList()));
  }
}

}  // namespace roundabout::mocap_bridge::natnet
