#include "mocap_bridge/sources/replay/pcapng.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "mocap_bridge/sources/replay/tcp_streams.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr std::uint32_t kSectionHeader = 0x0a0d0d0a;
constexpr std::uint32_t kInterface = 1;
constexpr std::uint32_t kSimplePacket = 3;
constexpr std::uint32_t kEnhancedPacket = 6;
constexpr std::uint16_t kResolutionOption = 9;
constexpr std::uint16_t kEthernet = 1;
constexpr std::uint16_t kRawIp = 101;
constexpr std::uint16_t kLinuxCooked = 113;
constexpr std::size_t kMostFragments = 64;  // of datagrams at a time that lack a part
constexpr std::size_t kLargestDatagram = 65535;
constexpr std::size_t kTcpHeader = 20;

struct Interface {
  std::uint16_t link = kEthernet;
  double tick_s = 1e-6;
};

struct Fragments {
  std::vector<std::byte> payload;
  std::size_t received = 0;
  std::optional<std::size_t> total;
};

class PcapngReader {
 public:
  PacketFile read(Bytes bytes) {
    LittleEndianCursor cursor(bytes);
    while (cursor.remaining() > 0 && file_.damage.empty()) {
      readBlock(cursor);
    }
    tcp_.finish(file_);
    return std::move(file_);
  }

 private:
  void readBlock(LittleEndianCursor& cursor) {
    const auto type = cursor.read<std::uint32_t>();
    const auto size = cursor.read<std::uint32_t>();
    if (cursor.failed() || size < 12 || size % 4 != 0) {
      file_.damage = "the capture breaks off or is not little-endian";
      return;
    }
    const Bytes body = cursor.take(size - 12);
    cursor.skip(4);
    if (cursor.failed()) {
      file_.damage = "the capture breaks off within a block";
      return;
    }
    LittleEndianCursor block(body);
    if (type == kSectionHeader) {
      interfaces_.clear();
      if (block.read<std::uint32_t>() != 0x1a2b3c4d) {
        file_.damage = "the capture is big-endian";
      }
    } else if (type == kInterface) {
      readInterface(block);
    } else if (type == kEnhancedPacket) {
      const auto interface = block.read<std::uint32_t>();
      const std::uint64_t high = block.read<std::uint32_t>();
      const std::uint64_t ticks = (high << 32) | block.read<std::uint32_t>();
      const auto captured = block.read<std::uint32_t>();
      block.skip(4);
      if (interface < interfaces_.size()) {
        const Interface& at = interfaces_[interface];
        readLink(at.link, block.take(captured), static_cast<double>(ticks) * at.tick_s);
      }
    } else if (type == kSimplePacket && !interfaces_.empty()) {
      block.skip(4);
      readLink(interfaces_[0].link, block.take(block.remaining()), 0.0);
    }
  }

  void readInterface(LittleEndianCursor& block) {
    Interface interface;
    interface.link = block.read<std::uint16_t>();
    block.skip(6);
    while (block.remaining() >= 4) {
      const auto option = block.read<std::uint16_t>();
      const auto size = block.read<std::uint16_t>();
      LittleEndianCursor value(block.take((size + 3U) / 4U * 4U));
      if (option == kResolutionOption && size >= 1) {
        const auto resolution = value.read<std::uint8_t>();
        interface.tick_s = (resolution & 0x80U) != 0 ? std::exp2(-(resolution & 0x7f))
                                                     : std::pow(10.0, -resolution);
      }
    }
    interfaces_.push_back(interface);
  }

  void readLink(std::uint16_t link, Bytes bytes, double time_s) {
    BigEndianCursor cursor(bytes);
    std::uint16_t protocol = 0x0800;
    if (link == kEthernet) {
      cursor.skip(12);
      protocol = cursor.read<std::uint16_t>();
      if (protocol == 0x8100) {  // VLAN
        cursor.skip(2);
        protocol = cursor.read<std::uint16_t>();
      }
    } else if (link == kLinuxCooked) {
      cursor.skip(14);
      protocol = cursor.read<std::uint16_t>();
    } else if (link != kRawIp) {
      return;
    }
    if (protocol == 0x0800 && !cursor.failed()) {
      readIp(cursor, time_s);
    }
  }

  void readIp(BigEndianCursor& cursor, double time_s) {
    const auto version_and_words = cursor.read<std::uint8_t>();
    cursor.skip(1);
    const std::size_t total = cursor.read<std::uint16_t>();
    const auto id = cursor.read<std::uint16_t>();
    const auto flags_and_offset = cursor.read<std::uint16_t>();
    cursor.skip(1);
    const auto protocol = cursor.read<std::uint8_t>();
    cursor.skip(2);
    const auto source = cursor.read<std::uint32_t>();
    const auto destination = cursor.read<std::uint32_t>();
    const std::size_t header = 4U * (version_and_words & 0x0fU);
    if (cursor.failed() || version_and_words >> 4 != 4 || header < 20 || total < header) {
      return;
    }
    cursor.skip(header - 20);
    const Bytes payload = cursor.take(total - header);
    if (cursor.failed()) {
      return;
    }
    const std::size_t offset = 8U * (flags_and_offset & 0x1fffU);
    const bool more = (flags_and_offset & 0x2000U) != 0;
    if (offset == 0 && !more) {
      readTransport({source, destination, id, protocol}, payload, time_s);
    } else {
      addFragment({source, destination, id, protocol}, payload, offset, more, time_s);
    }
  }

  using FragmentKey = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t, std::uint8_t>;

  void addFragment(const FragmentKey& key, Bytes payload, std::size_t offset, bool more,
                   double time_s) {
    if (offset + payload.size() > kLargestDatagram) {
      return;
    }
    if (fragments_.size() >= kMostFragments && !fragments_.contains(key)) {
      fragments_.clear();
    }
    Fragments& datagram = fragments_[key];
    if (datagram.payload.size() < offset + payload.size()) {
      datagram.payload.resize(offset + payload.size());
    }
    std::copy(payload.begin(), payload.end(),
              datagram.payload.begin() + static_cast<std::ptrdiff_t>(offset));
    datagram.received += payload.size();
    if (!more) {
      datagram.total = offset + payload.size();
    }
    if (datagram.total && datagram.received >= *datagram.total) {
      readTransport(key, datagram.payload, time_s);
      fragments_.erase(key);
    }
  }

  // The key says from whom to whom.
  void readTransport(const FragmentKey& key, Bytes bytes, double time_s) {
    constexpr std::uint8_t kTcp = 6;
    constexpr std::uint8_t kUdp = 17;
    const auto [source, destination, id, protocol] = key;
    // No clock shows more, and such a stamp says nothing.
    constexpr double kLargest_s = 1e11;
    const core::Utime received =
        time_s >= 0.0 && time_s <= kLargest_s ? core::toUtime(time_s) : core::Utime{0};
    if (protocol == kUdp) {
      readUdp(bytes, received);
    } else if (protocol == kTcp) {
      readTcp(source, destination, bytes, received);
    }
  }

  void readUdp(Bytes bytes, core::Utime received) {
    BigEndianCursor cursor(bytes);
    StoredPacket packet;
    packet.received = received;
    packet.transport = Transport::kUdp;
    packet.from_port = cursor.read<std::uint16_t>();
    packet.to_port = cursor.read<std::uint16_t>();
    const std::size_t size = cursor.read<std::uint16_t>();
    cursor.skip(2);
    if (cursor.failed() || size < 8 || size - 8 > cursor.remaining()) {
      return;
    }
    const Bytes payload = cursor.take(size - 8);
    packet.payload.assign(payload.begin(), payload.end());
    file_.packets.push_back(std::move(packet));
  }

  void readTcp(std::uint32_t source, std::uint32_t destination, Bytes bytes, core::Utime received) {
    BigEndianCursor cursor(bytes);
    TcpSegment segment;
    segment.from_address = source;
    segment.to_address = destination;
    segment.from_port = cursor.read<std::uint16_t>();
    segment.to_port = cursor.read<std::uint16_t>();
    segment.sequence = cursor.read<std::uint32_t>();
    cursor.skip(4);
    const std::size_t header = 4U * (cursor.read<std::uint8_t>() >> 4U);
    const auto flags = cursor.read<std::uint8_t>();
    segment.syn = (flags & 0x02U) != 0;
    segment.ack = (flags & 0x10U) != 0;
    if (cursor.failed() || header < kTcpHeader || header > bytes.size()) {
      return;
    }
    segment.payload = bytes.subspan(header);
    tcp_.add(segment, received, file_);
  }

  PacketFile file_;
  TcpStreams tcp_;
  std::vector<Interface> interfaces_;
  std::map<FragmentKey, Fragments> fragments_;
};

}  // namespace

bool looksLikePcapng(Bytes bytes) {
  return LittleEndianCursor(bytes).read<std::uint32_t>() == kSectionHeader;
}

PacketFile readPcapng(Bytes bytes) { return PcapngReader().read(bytes); }

}  // namespace roundabout::mocap_bridge
