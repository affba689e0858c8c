#include "tests/fuzz/targets.h"

#include <array>
#include <filesystem>
#include <stdexcept>

#include "common/core/error.h"
#include "mocap_bridge/sources/natnet/parser.h"
#include "mocap_bridge/sources/natnet/writer.h"
#include "mocap_bridge/sources/qualisys/parser.h"
#include "mocap_bridge/sources/replay/packet_file.h"
#include "mocap_bridge/sources/table.h"
#include "mocap_bridge/sources/vicon_udp/parser.h"
#include "mocap_bridge/sources/vrpn/parser.h"
#include "tests/support/mocap_fixtures.h"

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
  }
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

void append(std::vector<Input>& inputs, const std::vector<Input>& more) {
  inputs.insert(inputs.end(), more.begin(), more.end());
}

// The whole input as one packet, twice: state that the first leaves behind is met by the second.
void interpret(const char* protocol, const config::Mocap& settings, Bytes input) {
  const auto interpreter = protocolNamed(protocol).make_interpreter(settings);
  Nobody nobody;
  interpreter->onPacket({1'700'000'000'000'000, 1, 2, input}, nobody);
  interpreter->onPacket({1'700'000'000'005'000, 1, 2, input}, nobody);
}

// The first byte chooses the version, the rest is a datagram.
void runNatnet(Bytes input) {
  if (input.empty()) {
    return;
  }
  const natnet::Version version =
      kVersions[std::to_integer<std::size_t>(input[0]) % kVersions.size()];
  const Bytes datagram = input.subspan(1);
  config::Mocap settings;
  settings.version = natnet::text(version);
  interpret("natnet", settings, datagram);
  if (const auto message = natnet::parseMessage(datagram)) {
    natnet::Frame frame;
    natnet::parseFrame(message->payload, version, frame);
    natnet::ModelDef models;
    natnet::parseModelDef(message->payload, version, models);
    natnet::ServerInfo info;
    natnet::parseServerInfo(message->payload, info);
    natnet::parseBitstream(message->payload);
  }
}

std::vector<Input> natnetSeeds() {
  std::vector<Input> seeds;
  natnet::Frame frame;
  frame.bodies.resize(3);
  const natnet::ModelDef models{{{1, "hex1"}, {2, "hex2"}}, 0};
  std::vector<Input> datagrams =
      fixtures({"natnet_v2_nordmoen", "natnet_v3_mje-nz", "natnet_v4_synthetic"});
  for (std::size_t i = 0; i < kVersions.size(); ++i) {
    natnet::ServerInfo info;
    info.version = kVersions[i];
    append(datagrams, {natnet::writeFrame(frame, kVersions[i]),
                       natnet::writeModelDef(models, kVersions[i]), natnet::writeServerInfo(info)});
  }
  for (const Input& datagram : datagrams) {
    for (std::size_t version = 0; version < kVersions.size(); ++version) {
      Input& seed = seeds.emplace_back(1, std::byte(version));
      seed.insert(seed.end(), datagram.begin(), datagram.end());
    }
  }
  return seeds;
}

void runQualisys(Bytes input) {
  interpret("qualisys", {}, input);
  qualisys::Data data;
  qualisys::parseData(input, data);
  qualisys::parseBodyNames(input);
}

std::vector<Input> qualisysSeeds() {
  qualisys::Data data;
  data.bodies.resize(2);
  std::vector<Input> seeds = fixtures({"qualisys_synthetic", "qualisys_xml"});
  for (const auto component :
       {qualisys::Component::k6D, qualisys::Component::k6DEuler, qualisys::Component::k6DResidual,
        qualisys::Component::k6DEulerResidual}) {
    seeds.push_back(qualisys::writeData(data, component));
  }
  seeds.push_back(
      qualisys::writeText(qualisys::PacketType::kXml,
                          "<QTM_Parameters_Ver_1.19><The_6D><Body><Name>a</Name></Body></The_6D>"
                          "</QTM_Parameters_Ver_1.19>"));
  return seeds;
}

void runVrpn(Bytes input) {
  interpret("vrpn", {}, input);
  vrpn::Pose pose;
  vrpn::parsePose(input, pose);
  vrpn::parseDescription(input);
}

std::vector<Input> vrpnSeeds() {
  Input stream = vrpn::writeCookie();
  for (const Input& part :
       {vrpn::writeDescription(vrpn::kTypeDescription, 4, vrpn::kPoseType),
        vrpn::writeDescription(vrpn::kSenderDescription, 0, "hex1"),
        vrpn::writePose({5, 6, 0, 4, {}}, {}), vrpn::writePose({5, 5006, 0, 4, {}}, {})}) {
    stream.insert(stream.end(), part.begin(), part.end());
  }
  std::vector<Input> seeds = {stream};
  for (Input& fixture : fixtures({"vrpn_reference_server"})) {
    fixture.resize(std::min<std::size_t>(fixture.size(), 2000));
    seeds.push_back(std::move(fixture));
  }
  return seeds;
}

void runViconUdp(Bytes input) { interpret("vicon_udp", {}, input); }

std::vector<Input> viconUdpSeeds() {
  vicon::Block block{7, {{"hex1", {1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}}, {"hex2", {}, {}}}};
  std::vector<Input> seeds = {vicon::writeBlock(block)};
  append(seeds, fixtures({"vicon_udp_session-recorder"}));
  return seeds;
}

void runPacketFile(Bytes input) {
  try {
    parsePacketFile(input, "fuzz");
  } catch (const core::StartupError&) {
    // A file that cannot be read is said at the start.
  }
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
  for (const Input& seed : {capture, records, own.bytes()}) {
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
