#include "tests/fuzz/targets.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>

#include "common/core/error.h"
#include "mocap_bridge/sources/natnet/interpreter.h"
#include "mocap_bridge/sources/natnet/writer.h"
#include "mocap_bridge/sources/qualisys/parser.h"
#include "mocap_bridge/sources/replay/packet_file.h"
#include "mocap_bridge/sources/table.h"
#include "mocap_bridge/sources/vicon_udp/parser.h"
#include "mocap_bridge/sources/vrpn/parser.h"
#include "tests/support/mocap_fixtures.h"
#include "tests/support/tcp_capture.h"

namespace roundabout::test {

namespace {

using namespace mocap_bridge;

constexpr std::array<natnet::Version, 8> kVersions = {
    {{2, 5}, {2, 6}, {2, 9}, {2, 11}, {3, 0}, {4, 0}, {4, 1}, {4, 7}}};

struct Nobody final : PacketSink {
  void onFrame(const SourceFrame& frame) override {
    // Something must look at what was read.
    if (frame.bodies.size() > (1U << 24)) {
      std::abort();
    }
    ++frames;
  }

  std::size_t frames = 0;
};

std::vector<Input> fixtures(const std::vector<std::string>& folders) {
  std::vector<Input> inputs;
  for (const std::string& folder : folders) {
    std::error_code absent;
    for (const auto& entry :
         std::filesystem::directory_iterator(referenceFolder() / "mocap" / folder, absent)) {
      const std::string extension = entry.path().extension();
      if (extension == ".bin" || extension == ".xml") {
        inputs.push_back(readFileBytes(entry.path()));
      }
    }
  }
  return inputs;
}

// An input is packets, so that what one leaves behind is met by the next: a byte that chooses the
// time since the one before, u16 bytes, payload.
constexpr std::array<core::Utime, 8> kPauses = {0,       300,     5'000,     20'000,
                                                100'000, 400'000, 1'200'000, 12'000'000};
constexpr core::Utime kBegin = 1'700'000'000'000'000;

void addPacket(Input& input, Bytes payload, std::uint8_t pause = 2) {
  LittleEndianWriter writer;
  writer.put(pause);
  writer.put(static_cast<std::uint16_t>(payload.size()));
  writer.put(payload.first(std::min<std::size_t>(payload.size(), 0xffff)));
  input.insert(input.end(), writer.bytes().begin(), writer.bytes().end());
}

Input packets(const std::vector<Input>& payloads) {
  Input input;
  for (const Input& payload : payloads) {
    addPacket(input, payload);
  }
  return input;
}

template <class OnPacket>
void forEachPacket(Bytes input, OnPacket on_packet) {
  LittleEndianCursor cursor(input);
  core::Utime now = kBegin;
  while (cursor.remaining() > 0) {
    now += kPauses[cursor.read<std::uint8_t>() % kPauses.size()];
    const std::size_t size = cursor.read<std::uint16_t>();
    on_packet(Packet{now, 1, 2, cursor.take(std::min(size, cursor.remaining()))});
  }
}

std::size_t interpret(const char* protocol, const config::Mocap& settings, Bytes input) {
  const auto interpreter = protocolNamed(protocol).make_interpreter(settings);
  Nobody nobody;
  forEachPacket(input, [&](const Packet& packet) { interpreter->onPacket(packet, nobody); });
  return nobody.frames;
}

// The first byte chooses the version, the rest are datagrams.
std::size_t runNatnet(Bytes input) {
  if (input.empty()) {
    return 0;
  }
  const natnet::Version version =
      kVersions[std::to_integer<std::size_t>(input[0]) % kVersions.size()];
  natnet::NatnetInterpreter interpreter({version, 0.005, 0.0});
  Nobody nobody;
  forEachPacket(input.subspan(1), [&](const Packet& packet) {
    interpreter.onPacket(packet, nobody);
    const auto message = natnet::parseMessage(packet.payload);
    if (!message) {
      return;
    }
    natnet::EchoResponse echo;
    if (message->id == natnet::MessageId::kEchoResponse &&
        natnet::parseEchoResponse(message->payload, echo) == nullptr) {
      interpreter.addEcho(echo, packet.received);
    }
    natnet::Frame frame;
    natnet::parseFrame(message->payload, version, frame);
    natnet::ModelDef models;
    natnet::parseModelDef(message->payload, version, models);
    natnet::ServerInfo info;
    natnet::parseServerInfo(message->payload, info);
    natnet::parseBitstream(message->payload);
  });
  return nobody.frames;
}

std::vector<Input> natnetSeeds() {
  std::vector<Input> seeds;
  natnet::Frame frame;
  frame.bodies.resize(3);
  const natnet::ModelDef models{{{1, "hex1"}, {2, "hex2"}}, 0};
  const auto add = [&](std::size_t version, const std::vector<Input>& datagrams) {
    Input& seed = seeds.emplace_back(1, std::byte(version));
    const Input rest = packets(datagrams);
    seed.insert(seed.end(), rest.begin(), rest.end());
  };
  for (std::size_t i = 0; i < kVersions.size(); ++i) {
    natnet::ServerInfo info;
    info.version = kVersions[i];
    info.tick_frequency_hz = 1'000'000;
    std::vector<Input> session = {natnet::writeServerInfo(info),
                                  natnet::writeModelDef(models, kVersions[i])};
    for (int k = 0; k < 5; ++k) {
      ++frame.number;
      const auto ticks = static_cast<std::uint64_t>(5'000 * frame.number);
      frame.timestamp_s = 1e-6 * static_cast<double>(ticks);
      frame.mid_exposure_ticks = ticks;
      frame.transmit_ticks = ticks + 1'000;
      session.push_back(natnet::writeFrame(frame, kVersions[i]));
      session.push_back(natnet::writeEchoResponse({kBegin, ticks}));
    }
    session.push_back(natnet::writeText(natnet::MessageId::kResponse, "Bitstream,3.1.0.0"));
    session.push_back(natnet::writeFrame(frame, {3, 1}));
    // From another version to this one.
    add((i + 1) % kVersions.size(), session);
  }
  for (const Input& datagram :
       fixtures({"natnet_v2_nordmoen", "natnet_v3_mje-nz", "natnet_v4_synthetic"})) {
    for (std::size_t version = 0; version < kVersions.size(); ++version) {
      add(version, {datagram});
    }
  }
  return seeds;
}

std::size_t runQualisys(Bytes input) {
  forEachPacket(input, [](const Packet& packet) {
    const Bytes payload =
        packet.payload.subspan(std::min(packet.payload.size(), qualisys::kHeaderBytes));
    qualisys::Data data;
    qualisys::parseData(payload, data);
    qualisys::parseBodyNames(payload);
  });
  return interpret("qualisys", {}, input);
}

std::vector<Input> qualisysSeeds() {
  qualisys::Data data;
  data.bodies.resize(2);
  std::vector<Input> session = {
      qualisys::writeText(qualisys::PacketType::kCommand, "QTM RT Interface connected"),
      qualisys::writeText(qualisys::PacketType::kXml,
                          "<QTM_Parameters_Ver_1.19><The_6D><Body><Name>a</Name></Body><Body>"
                          "<Name>b</Name></Body></The_6D></QTM_Parameters_Ver_1.19>")};
  for (const auto event : {qualisys::Event::kRtFromFileStarted, qualisys::Event::kCaptureStarted,
                           qualisys::Event::kCameraSettingsChanged}) {
    const std::byte number{static_cast<std::uint8_t>(event)};
    session.push_back(qualisys::writePacket(qualisys::PacketType::kEvent, Bytes(&number, 1)));
  }
  for (const auto component :
       {qualisys::Component::k6D, qualisys::Component::k6DEuler, qualisys::Component::k6DResidual,
        qualisys::Component::k6DEulerResidual}) {
    data.timestamp_us += 5'000;
    session.push_back(qualisys::writeData(data, component));
  }
  std::vector<Input> seeds = {packets(session)};
  for (const Input& fixture : fixtures({"qualisys_synthetic", "qualisys_xml"})) {
    seeds.push_back(packets({fixture}));
  }
  return seeds;
}

std::size_t runVrpn(Bytes input) {
  forEachPacket(input, [](const Packet& packet) {
    vrpn::Pose pose;
    vrpn::parsePose(packet.payload, pose);
    vrpn::parseDescription(packet.payload);
  });
  return interpret("vrpn", {}, input);
}

std::vector<Input> vrpnSeeds() {
  std::vector<Input> session = {vrpn::writeCookie(),
                                vrpn::writeDescription(vrpn::kTypeDescription, 4, vrpn::kPoseType),
                                vrpn::writeDescription(vrpn::kSenderDescription, 0, "hex1"),
                                vrpn::writeDescription(vrpn::kSenderDescription, 1, "hex2")};
  for (std::int32_t k = 0; k < 5; ++k) {
    session.push_back(vrpn::writePose({5, 5'000 * k, 0, 4, {}}, {}));
    session.push_back(vrpn::writePose({5, 5'000 * k, 1, 4, {}}, {}));
  }
  std::vector<Input> seeds = {packets(session)};
  for (Input& fixture : fixtures({"vrpn_reference_server"})) {
    fixture.resize(std::min<std::size_t>(fixture.size(), 2000));
    seeds.push_back(packets({fixture}));
  }
  return seeds;
}

std::size_t runViconUdp(Bytes input) {
  config::Mocap settings;
  settings.rate_hz = 200.0;
  return interpret("vicon_udp", settings, input);
}

std::vector<Input> viconUdpSeeds() {
  std::vector<Input> session;
  for (std::uint32_t frame = 7; frame < 12; ++frame) {
    for (const char* name : {"hex1", "hex2"}) {  // in two blocks
      session.push_back(
          vicon::writeBlock({frame, {{name, {1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}}, {"", {}, {}}}}));
    }
  }
  std::vector<Input> seeds = {packets(session)};
  for (const Input& fixture : fixtures({"vicon_udp_session-recorder"})) {
    seeds.push_back(packets({fixture}));
  }
  return seeds;
}

std::size_t runPacketFile(Bytes input) {
  try {
    return parsePacketFile(input, "fuzz").packets.size();
  } catch (const core::StartupError&) {
    // A file that cannot be read is said at the start.
  }
  return 0;
}

// Three segments of a server, the middle one late, and one that never comes.
Input tcpCapture() {
  constexpr std::uint32_t kServer = 0x0a000001;
  constexpr std::uint32_t kClient = 0x0a000002;
  constexpr std::uint32_t kFirst = 0xffffffe0;  // its numbers overflow
  const Input said = vrpn::writeCookie();
  TcpCapture capture;
  const auto add = [&](core::Utime arrival, std::uint32_t place, Bytes bytes, bool syn = false) {
    capture.add({kServer, kClient, vrpn::kDefaultPort, 40'000, kFirst + place, syn, true, bytes},
                kBegin + arrival);
  };
  capture.add({kClient, kServer, 40'000, vrpn::kDefaultPort, 5000, true, false, {}}, kBegin);
  add(1'000, 0, {}, true);
  capture.add({kClient, kServer, 40'000, vrpn::kDefaultPort, 5001, false, true, said},
              kBegin + 2'000);
  const Bytes bytes(said);
  add(3'000, 1, bytes.first(8));
  add(4'000, 17, bytes.subspan(16, 8));
  add(5'000, 9, bytes.subspan(8, 8));
  add(5'000, 9, bytes.subspan(8, 8));
  add(6'000, 49, bytes.first(8));
  add(2'000'000, 57, bytes.first(8));
  return capture.bytes();
}

std::vector<Input> packetFileSeeds() {
  std::vector<Input> seeds;
  Input capture = readFileBytes(referenceFolder() / "mocap/natnet_v3_mje-nz/raw/traffic.pcapng");
  capture.resize(std::min<std::size_t>(capture.size(), 3000));
  Input records = mocapFixture("natnet_v3_mje-nz/extracted/datagrams.bin");
  records.resize(std::min<std::size_t>(records.size(), 2000));
  LittleEndianWriter own;
  own.put(1.7e9);
  own.put<std::uint16_t>(1510);
  own.put<std::uint16_t>(1511);
  own.put<std::uint32_t>(4);
  own.put<std::uint32_t>(9);
  for (const Input& seed : {capture, records, own.bytes(), tcpCapture()}) {
    if (!seed.empty()) {
      seeds.push_back(seed);
    }
  }
  return seeds;
}

}  // namespace

std::span<const FuzzTarget> fuzzTargets() {
  static const std::array<FuzzTarget, 5> kTargets = {{
      {"natnet", runNatnet, natnetSeeds},
      {"qualisys", runQualisys, qualisysSeeds},
      {"vrpn", runVrpn, vrpnSeeds},
      {"vicon_udp", runViconUdp, viconUdpSeeds},
      {"packet_file", runPacketFile, packetFileSeeds},
  }};
  return kTargets;
}

const FuzzTarget& fuzzTargetNamed(const std::string& name) {
  for (const FuzzTarget& target : fuzzTargets()) {
    if (name == target.name) {
      return target;
    }
  }
  throw std::runtime_error("nothing to fuzz is called " + name);
}

}  // namespace roundabout::test
