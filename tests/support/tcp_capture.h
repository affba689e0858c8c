#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mocap_bridge/sources/byte_writer.h"
#include "mocap_bridge/sources/replay/tcp_streams.h"

namespace roundabout::test {

/// A pcapng capture of TCP segments over IPv4, without link headers.
class TcpCapture {
 public:
  TcpCapture() {
    // A section, and an interface of raw IP.
    for (const std::uint32_t word : {0x0a0d0d0aU, 28U, 0x1a2b3c4dU, 1U, 0xffffffffU, 0xffffffffU,
                                     28U, 1U, 20U, 101U, 0U, 20U}) {
      file_.put(word);
    }
  }

  /// `stamp_high`: instead of the upper half of the arrival.
  void add(const mocap_bridge::TcpSegment& segment, core::Utime arrival,
           std::optional<std::uint32_t> stamp_high = {}) {
    mocap_bridge::BigEndianWriter frame;
    frame.put<std::uint32_t>(0x45000000U + static_cast<std::uint32_t>(40 + segment.payload.size()));
    frame.put<std::uint32_t>(0);
    frame.put<std::uint32_t>(0x40060000);
    frame.put(segment.from_address);
    frame.put(segment.to_address);
    frame.put(segment.from_port);
    frame.put(segment.to_port);
    frame.put(segment.sequence);
    frame.put<std::uint32_t>(0);
    frame.put<std::uint8_t>(0x50);
    frame.put<std::uint8_t>(
        static_cast<std::uint8_t>((segment.syn ? 0x02 : 0) | (segment.ack ? 0x10 : 0)));
    frame.put<std::uint16_t>(1000);
    frame.put<std::uint32_t>(0);
    frame.put(segment.payload);
    const auto padded = static_cast<std::uint32_t>((frame.size() + 3) / 4 * 4);
    const std::size_t end = file_.size() + 28 + padded;
    file_.put<std::uint32_t>(6);
    file_.put<std::uint32_t>(32 + padded);
    file_.put<std::uint32_t>(0);
    file_.put(stamp_high.value_or(static_cast<std::uint32_t>(arrival >> 32)));
    file_.put(static_cast<std::uint32_t>(arrival));
    file_.put(static_cast<std::uint32_t>(frame.size()));
    file_.put(static_cast<std::uint32_t>(frame.size()));
    file_.put(mocap_bridge::Bytes(frame.bytes()));
    file_.resize(end);
    file_.put<std::uint32_t>(32 + padded);
  }

  const std::vector<std::byte>& bytes() const { return file_.bytes(); }

 private:
  mocap_bridge::LittleEndianWriter file_;
};

}  // namespace roundabout::test
