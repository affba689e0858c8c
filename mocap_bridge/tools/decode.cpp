#include "mocap_bridge/tools/decode.h"

#include <cmath>
#include <cstdio>
#include <iostream>

#include <nlohmann/json.hpp>

#include "mocap_bridge/sources/replay/packet_feed.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

namespace {

using Json = nlohmann::ordered_json;

// What is not finite is null in JSON.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json bodyJson(const BodyPose& body) {
  Json json;
  if (body.id >= 0) {
    json["id"] = body.id;
  }
  if (!body.name.empty()) {
    json["name"] = body.name;
  }
  const Eigen::Vector3d& at = body.position_m;
  const Eigen::Quaterniond& turned = body.orientation;
  json["position"] = {number(at.x()), number(at.y()), number(at.z())};
  json["quaternion"] = {number(turned.x()), number(turned.y()), number(turned.z()),
                        number(turned.w())};
  json["tracked"] = body.tracked;
  if (std::isfinite(body.residual_m)) {
    json["residual_m"] = body.residual_m;
  }
  return json;
}

// "7 hexA": streaming id and name.
Json definitionJson(const std::string& text) {
  const std::size_t blank = text.find(' ');
  return {{"id", Json::parse(text.substr(0, blank))}, {"name", text.substr(blank + 1)}};
}

// Texts and versions stay text, whatever they look like.
bool isNumber(std::string_view key, const std::string& value) {
  return key != "text" && !key.ends_with("version") && key != "bitstream" && !value.empty() &&
         value.find_first_not_of("0123456789") == std::string::npos &&
         (value[0] != '0' || value.size() == 1);
}

class JsonLines final : public PacketSink {
 public:
  void startPacket(const std::string& file, const StoredPacket& packet) {
    file_ = &file;
    packet_ = &packet;
  }

  void onFrame(const SourceFrame& frame) override {
    Json json = line("frame");
    json["frame"] = frame.number;
    for (const FrameStamp& stamp : frame.stamps) {
      json[stamp.name] = stamp.is_ticks ? Json(stamp.ticks) : number(stamp.seconds);
    }
    if (frame.recorded) {
      json["recorded"] = true;
    }
    json["bodies"] = Json::array();
    for (const BodyPose& body : frame.bodies) {
      json["bodies"].push_back(bodyJson(body));
    }
    print(json);
  }

  void onPacket(const PacketFacts& facts) override {
    Json json = line(facts.kind);
    for (const auto& [key, value] : facts.facts) {
      if (key == std::string_view("definition")) {
        json["bodies"].push_back(definitionJson(value));
      } else if (key == std::string_view("body")) {
        json["bodies"].push_back({{"name", value}});
      } else {
        json[key] = isNumber(key, value) ? Json::parse(value) : Json(value);
      }
    }
    if (facts.error != nullptr) {
      json["error"] = facts.error;
      failed_ = true;
    }
    print(json);
  }

  bool failed() const { return failed_; }

 private:
  Json line(const char* kind) const {
    Json json;
    json["type"] = kind;
    if (packet_->received != 0) {
      json["received_s"] = core::toSeconds(packet_->received);
    } else {
      json["file"] = *file_;
    }
    return json;
  }
  // Names come off the wire: what is not UTF-8 is replaced.
  static void print(const Json& json) {
    std::cout << json.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
  }

  const std::string* file_ = nullptr;
  const StoredPacket* packet_ = nullptr;
  bool failed_ = false;
};

struct Nobody final : PacketSink {
  void onFrame(const SourceFrame&) override {}
};

// Files may come in any order: the one that tells the version need not be the first.
std::string versionAmong(const std::vector<PacketFile>& files, const Protocol& protocol,
                         const config::Mocap& settings) {
  const auto interpreter = protocol.make_interpreter(settings);
  Nobody nobody;
  for (const PacketFile& file : files) {
    PacketFeed feed(protocol, settings, file);
    for (const StoredPacket& packet : file.packets) {
      feed.feed(packet, *interpreter, nobody);
      if (!interpreter->version().empty()) {
        return interpreter->version();
      }
    }
  }
  return settings.version;
}

}  // namespace

int decode(const DecodeOptions& options) {
  const Protocol& protocol = protocolNamed(options.protocol);
  config::Mocap settings;
  settings.version = options.version;
  std::vector<PacketFile> files;
  for (const std::string& file : options.files) {
    files.push_back(readPacketFile(file));
  }
  settings.version = versionAmong(files, protocol, settings);
  const auto interpreter = protocol.make_interpreter(settings);
  interpreter->showEverything();
  JsonLines lines;
  bool damaged = false;
  for (std::size_t i = 0; i < files.size(); ++i) {
    PacketFeed feed(protocol, settings, files[i]);
    for (const StoredPacket& packet : files[i].packets) {
      lines.startPacket(options.files[i], packet);
      feed.feed(packet, *interpreter, lines);
    }
    if (const std::string remark = feed.remark(); !remark.empty()) {
      std::fprintf(stderr, "%s: %s\n", options.files[i].c_str(), remark.c_str());
    }
    if (!files[i].damage.empty()) {
      std::fprintf(stderr, "%s: %s\n", options.files[i].c_str(), files[i].damage.c_str());
      damaged = true;
    }
  }
  return lines.failed() || damaged ? 1 : 0;
}

}  // namespace roundabout::mocap_bridge
