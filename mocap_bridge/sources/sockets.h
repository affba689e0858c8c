#pragma once

// IPv4 sockets that never block. Set-up throws core::StartupError; afterwards everything is a
// return value.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/config/experiment.h"
#include "mocap_bridge/sources/byte_cursor.h"

namespace roundabout::mocap_bridge {

/// An IPv4 address and a port, host byte order.
struct Endpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
  bool operator==(const Endpoint&) const = default;
};

/// "192.168.0.106", and with the port "192.168.0.106:1510".
std::string addressText(std::uint32_t address);
std::string text(const Endpoint& endpoint);

/// Numbers or a host name to an address. Throws core::StartupError that names `key`.
std::uint32_t resolveAddress(const std::string& key, const std::string& host);
/// mocap.server at mocap.command_port, or at the protocol's own port if that is 0. Throws as above.
Endpoint serverOf(const config::Mocap& mocap, std::uint16_t usual_port);
/// Of an interface, by its address or its name ("eth0"); empty: any (0). Throws core::StartupError
/// that lists this machine's interfaces.
std::uint32_t interfaceAddress(const std::string& key, const std::string& interface);
/// "lo 127.0.0.1, eth0 192.168.0.100".
std::string interfaceList();

inline constexpr std::uint32_t kAnyAddress = 0;
inline constexpr std::uint32_t kLoopback = 0x7f000001;
inline bool isMulticast(std::uint32_t address) { return (address >> 28) == 0xe; }

/// A file descriptor with an owner.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : descriptor_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  int get() const { return descriptor_; }
  int release();

 private:
  int descriptor_ = -1;
};

/// Two UDP ports of this machine's loopback that nobody uses now, and that differ.
std::pair<int, int> freePorts();

class UdpSocket {
 public:
  /// Of datagrams to this machine, only one of those who share a port hears each: a second listener
  /// takes them away from the first.
  enum class Port { kShared, kAlone };

  /// Port 0: one that is free. The receive buffer holds a MiB where the machine allows it. `what`
  /// names the socket in errors. Throws core::StartupError.
  UdpSocket(const std::string& what, Endpoint local, Port port = Port::kShared);

  /// On the interface with that address; any: the one that the routes say. Throws
  /// core::StartupError.
  void joinGroup(std::uint32_t group, std::uint32_t interface);
  /// Multicast leaves through that interface, and is heard on this machine too.
  void sendThrough(std::uint32_t interface);

  bool send(const Endpoint& to, Bytes bytes);

  struct Received {
    Endpoint from;
    Bytes payload;  ///< valid until the next call; empty datagrams are possible
  };
  /// The next datagram, if there is one.
  std::optional<Received> receive();

  std::uint16_t port() const;
  int descriptor() const { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
  std::vector<std::byte> buffer_;
};

/// A TCP connection, made or accepted.
class TcpStream {
 public:
  enum class State { kConnecting, kOpen, kClosed };

  /// Begins to connect; is closed from the start where this machine has no socket to give.
  explicit TcpStream(const Endpoint& server);
  explicit TcpStream(Descriptor accepted);

  /// Asks the system how it stands with the connection.
  State state();
  /// All of it or, where the other side does not read, nothing more: the stream is then closed.
  bool send(Bytes bytes);
  /// What has arrived, at most 64 KiB a call; empty: nothing now. Closes the stream at its end.
  Bytes receive();
  void close();

  int descriptor() const { return descriptor_.get(); }
  bool connecting() const { return state_ == State::kConnecting; }
  /// Why there was no socket; empty: there was one.
  const std::string& failure() const { return failure_; }

 private:
  Descriptor descriptor_;
  State state_;
  std::string failure_;
  std::vector<std::byte> buffer_;
};

class TcpListener {
 public:
  TcpListener(const std::string& what, Endpoint local);
  std::unique_ptr<TcpStream> accept();
  std::uint16_t port() const;
  int descriptor() const { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
};

}  // namespace roundabout::mocap_bridge
