#include <algorithm>
#include <cctype>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "mocap_bridge/sources/qualisys/session.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

namespace {

using namespace qualisys;

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return out;
}

/// QTM with its real-time server: any version from 1.8 to 1.28, settings of 6D bodies, streaming of
/// the four 6D components over TCP.
class QualisysEmulator final : public Emulator {
 public:
  explicit QualisysEmulator(const EmulatorSettings& settings)
      : listener_("QTM port",
                  {resolveAddress("--address", settings.address),
                   settings.command_port == 0 ? kDefaultPort
                                              : static_cast<std::uint16_t>(settings.command_port)}),
        rate_hz_(settings.rate_hz) {}

  void poll(core::Utime now) override {
    began_ = began_ == 0 ? now : began_;
    while (auto stream = listener_.accept()) {
      stream->send(writeText(PacketType::kCommand, "QTM RT Interface connected"));
      clients_.emplace_back().stream = std::move(stream);
    }
    for (Client& client : clients_) {
      serve(client);
    }
    std::erase_if(clients_, [](const Client& client) { return client.stream->descriptor() < 0; });
  }

  void send(const SourceFrame& frame, core::Utime now) override {
    began_ = began_ == 0 ? now : began_;
    names_.clear();
    if (frame.recorded != from_file_) {
      from_file_ = frame.recorded;
      for (Client& client : clients_) {
        sendEvent(client, from_file_ ? Event::kRtFromFileStarted : Event::kRtFromFileStopped);
      }
    }
    Data data;
    data.timestamp_us = static_cast<std::uint64_t>(
        std::max<core::Utime>(frame.exposure_utime - began_ + core::kMicrosPerSecond, 0));
    data.frame = static_cast<std::uint32_t>(frame.number);
    for (const BodyPose& body : frame.bodies) {
      names_.push_back(body.name);
      Body& out = data.bodies.emplace_back();
      out.tracked = body.tracked;
      Eigen::Map<Eigen::Vector3d>(out.position_mm.data()) = 1000.0 * body.position_m;
      Eigen::Map<Eigen::Matrix3d>(out.rotation.data()) =
          body.orientation.normalized().toRotationMatrix();
      out.residual_mm = 0.5;
    }
    for (Client& client : clients_) {
      if (client.component) {
        client.stream->send(writeData(data, *client.component));
      }
    }
  }

  void addDescriptors(std::vector<pollfd>& descriptors) const override {
    descriptors.push_back({listener_.descriptor(), POLLIN, 0});
    for (const Client& client : clients_) {
      descriptors.push_back({client.stream->descriptor(), POLLIN, 0});
    }
  }
  int commandPort() const override { return listener_.port(); }

 private:
  struct Client {
    std::unique_ptr<TcpStream> stream;
    std::vector<std::byte> received;
    int minor = 1;
    std::optional<Component> component;  // what it asked to have streamed
  };

  static void sendEvent(Client& client, Event event) {
    const std::byte number{static_cast<std::uint8_t>(event)};
    client.stream->send(writePacket(PacketType::kEvent, Bytes(&number, 1)));
  }

  void serve(Client& client) {
    for (Bytes bytes = client.stream->receive(); !bytes.empty(); bytes = client.stream->receive()) {
      client.received.insert(client.received.end(), bytes.begin(), bytes.end());
    }
    Bytes stream(client.received);
    bool broken = false;
    while (const auto packet = takePacket(stream, broken)) {
      if (packet->type == PacketType::kCommand) {
        obey(client, parseText(packet->payload));
      }
    }
    if (broken) {
      client.stream->close();
    }
    client.received.assign(stream.begin(), stream.end());
  }

  void obey(Client& client, const std::string& text) {
    const std::string command = lowerCase(text);
    const auto answer = [&](const std::string& words) {
      client.stream->send(writeText(PacketType::kCommand, words));
    };
    const auto refuse = [&](const std::string& words) {
      client.stream->send(writeText(PacketType::kError, words));
    };
    if (command.starts_with("version 1.")) {
      const int minor = std::atoi(command.c_str() + std::string_view("version 1.").size());
      if (minor < kOldestMinor || minor > kNewestMinor) {
        refuse("Version NOT supported");
        return;
      }
      client.minor = minor;
      answer(fmt::format("Version set to 1.{}", minor));
    } else if (command == "version") {
      answer(fmt::format("Version is 1.{}", client.minor));
    } else if (command == "qtmversion") {
      answer("QTM Version is 2023.3 (emulated)");
    } else if (command == "byteorder") {
      answer("Byte order is little endian");
    } else if (command.starts_with("getparameters")) {
      client.stream->send(writeText(PacketType::kXml, settingsXml(client.minor)));
    } else if (command == "getstate") {
      sendEvent(client, from_file_ ? Event::kRtFromFileStarted : Event::kCaptureStarted);
    } else if (command == "streamframes stop") {
      client.component.reset();
    } else if (command.starts_with("streamframes") || command.starts_with("getcurrentframe")) {
      client.component = componentIn(command);
      if (!client.component) {
        refuse("Parse error");
      }
    } else {
      refuse("Parse error");
    }
  }

  static std::optional<Component> componentIn(const std::string& command) {
    for (const auto& [word, component] :
         {std::pair{"6deulerres", Component::k6DEulerResidual},
          std::pair{"6deuler", Component::k6DEuler}, std::pair{"6dres", Component::k6DResidual},
          std::pair{"6d", Component::k6D}}) {
      if (command.find(word) != std::string::npos) {
        return component;
      }
    }
    return std::nullopt;
  }

  std::string settingsXml(int minor) const {
    std::string bodies;
    for (const std::string& name : names_) {
      bodies += fmt::format(
          "<Body><Name>{}</Name><Enabled>true</Enabled><Color R=\"0\" G=\"255\" B=\"0\"/>"
          "<Points></Points></Body>",
          escaped(name));
    }
    return fmt::format(
        "<QTM_Parameters_Ver_1.{0}><General><Frequency>{1}</Frequency></General><The_6D>{2}"
        "</The_6D></QTM_Parameters_Ver_1.{0}>",
        minor, rate_hz_, bodies);
  }

  TcpListener listener_;
  double rate_hz_;
  core::Utime began_ = 0;
  bool from_file_ = false;
  std::vector<Client> clients_;
  std::vector<std::string> names_;
};

std::unique_ptr<Source> makeSession(const config::Mocap& mocap) {
  return std::make_unique<QualisysSession>(mocap);
}

std::unique_ptr<Interpreter> makeInterpreter(const config::Mocap& mocap) {
  return std::make_unique<QualisysInterpreter>(mocap);
}

std::unique_ptr<Emulator> makeEmulator(const EmulatorSettings& settings) {
  return std::make_unique<QualisysEmulator>(settings);
}

}  // namespace

namespace qualisys {

Protocol protocol() {
  return {"qualisys", "z_up", qualisys::kDefaultPort, makeSession, makeInterpreter, makeEmulator};
}

}  // namespace qualisys

}  // namespace roundabout::mocap_bridge
