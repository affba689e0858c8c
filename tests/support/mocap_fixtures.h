#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "mocap_bridge/sources/source.h"
#include "tests/support/reference.h"

namespace roundabout::test {

using FileBytes = std::vector<std::byte>;

inline FileBytes readFileBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = mocap_bridge::bytesOf(text);
  return {bytes.begin(), bytes.end()};
}

/// Captured and synthetic motion-capture packets; empty where they are not beside the project.
inline FileBytes mocapFixture(const std::string& name) {
  return readFileBytes(referenceFolder() / "mocap" / name);
}

/// Keeps what a parser or session delivers.
struct Collected final : mocap_bridge::PacketSink {
  struct Facts {
    std::string kind;
    std::string error;
    std::vector<std::pair<std::string, std::string>> facts;
  };

  void onFrame(const mocap_bridge::SourceFrame& frame) override { frames.push_back(frame); }
  void onPacket(const mocap_bridge::PacketFacts& packet) override {
    Facts& out = packets.emplace_back();
    out.kind = packet.kind;
    out.error = packet.error == nullptr ? "" : packet.error;
    for (const auto& [key, value] : packet.facts) {
      out.facts.emplace_back(key, value);
    }
  }

  std::vector<mocap_bridge::SourceFrame> frames;
  std::vector<Facts> packets;
};

}  // namespace roundabout::test
