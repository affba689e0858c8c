#include "mocap_bridge/sources/sockets.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr int kReceiveBuffer = 1 << 20;
constexpr std::size_t kLargestDatagram = 65536;

sockaddr_in toSystem(const Endpoint& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(endpoint.address);
  address.sin_port = htons(endpoint.port);
  return address;
}

Endpoint fromSystem(const sockaddr_in& address) {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

template <class Value>
void set(const Descriptor& socket, int level, int option, const Value& value) {
  setsockopt(socket.get(), level, option, &value, sizeof(value));
}

Descriptor makeSocket(const std::string& what, int type) {
  Descriptor socket(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (socket.get() < 0) {
    throw core::StartupError("network", what, "a socket", std::strerror(errno));
  }
  return socket;
}

void bindTo(const std::string& what, const Descriptor& socket, const Endpoint& local,
            bool alone = false) {
  set(socket, SOL_SOCKET, SO_REUSEADDR, alone ? 0 : 1);
  const sockaddr_in address = toSystem(local);
  if (bind(socket.get(), generic(address), sizeof(address)) != 0) {
    const bool taken = alone && errno == EADDRINUSE;
    throw core::StartupError(
        "network", what,
        "that " + text(local) + " can be listened on" + (alone ? " by this program alone" : ""),
        taken ? "another that listens there: is mocap_bridge running, or "
                "mocap watch?"
              : std::strerror(errno));
  }
}

std::uint16_t portOf(const Descriptor& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return fromSystem(address).port;
}

template <class Call>
void forEveryInterface(Call call) {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) {
    return;
  }
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET) {
      sockaddr_in address;
      std::memcpy(&address, one->ifa_addr, sizeof(address));
      call(std::string(one->ifa_name), fromSystem(address).address);
    }
  }
  freeifaddrs(all);
}

}  // namespace

std::string addressText(std::uint32_t address) {
  char text[INET_ADDRSTRLEN] = {};
  const in_addr raw{htonl(address)};
  inet_ntop(AF_INET, &raw, text, sizeof(text));
  return text;
}

std::string text(const Endpoint& endpoint) {
  return addressText(endpoint.address) + ":" + std::to_string(endpoint.port);
}

Endpoint serverOf(const config::Mocap& mocap, std::uint16_t usual_port) {
  return {resolveAddress("mocap.server", mocap.server),
          mocap.command_port == 0 ? usual_port : static_cast<std::uint16_t>(mocap.command_port)};
}

std::uint32_t resolveAddress(const std::string& key, const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (error != 0 || found == nullptr) {
    throw core::StartupError("network", key, "the address or name of a machine",
                             "\"" + host + "\": " + gai_strerror(error));
  }
  sockaddr_in address;
  std::memcpy(&address, found->ai_addr, sizeof(address));
  freeaddrinfo(found);
  return fromSystem(address).address;
}

std::uint32_t interfaceAddress(const std::string& key, const std::string& interface) {
  if (interface.empty()) {
    return kAnyAddress;
  }
  std::optional<std::uint32_t> found;
  forEveryInterface([&](const std::string& name, std::uint32_t address) {
    if (!found && (name == interface || addressText(address) == interface)) {
      found = address;
    }
  });
  if (!found) {
    throw core::StartupError("network", key,
                             "an interface of this machine (" + interfaceList() + ")",
                             "\"" + interface + "\"");
  }
  return *found;
}

std::string interfaceList() {
  std::string list;
  forEveryInterface([&](const std::string& name, std::uint32_t address) {
    list += (list.empty() ? "" : ", ") + name + " " + addressText(address);
  });
  return list;
}

Descriptor::~Descriptor() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

int Descriptor::release() { return std::exchange(descriptor_, -1); }

std::pair<int, int> freePorts() {
  // Both held until both are known; sockets that share ports could be given the same.
  const UdpSocket one("a free port", {kLoopback, 0}, UdpSocket::Port::kAlone);
  const UdpSocket other("a free port", {kLoopback, 0}, UdpSocket::Port::kAlone);
  return {one.port(), other.port()};
}

UdpSocket::UdpSocket(const std::string& what, Endpoint local, Port port)
    : descriptor_(makeSocket(what, SOCK_DGRAM)), buffer_(kLargestDatagram) {
  set(descriptor_, SOL_SOCKET, SO_RCVBUF, kReceiveBuffer);
  set(descriptor_, SOL_SOCKET, SO_BROADCAST, 1);
  bindTo(what, descriptor_, local, port == Port::kAlone);
}

void UdpSocket::joinGroup(std::uint32_t group, std::uint32_t interface) {
  const ip_mreq membership{{htonl(group)}, {htonl(interface)}};
  // Else Linux hands this socket what other sockets of the machine have joined.
  set(descriptor_, IPPROTO_IP, IP_MULTICAST_ALL, 0);
  if (setsockopt(descriptor_.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership,
                 sizeof(membership)) != 0) {
    throw core::StartupError("network", "multicast group " + addressText(group),
                             "that it can be joined on interface " + addressText(interface) +
                                 " (this machine has " + interfaceList() + ")",
                             std::strerror(errno));
  }
}

void UdpSocket::sendThrough(std::uint32_t interface) {
  set(descriptor_, IPPROTO_IP, IP_MULTICAST_IF, in_addr{htonl(interface)});
  set(descriptor_, IPPROTO_IP, IP_MULTICAST_LOOP, 1);
}

bool UdpSocket::send(const Endpoint& to, Bytes bytes) {
  const sockaddr_in address = toSystem(to);
  return sendto(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL, generic(address),
                sizeof(address)) == static_cast<ssize_t>(bytes.size());
}

std::optional<UdpSocket::Received> UdpSocket::receive() {
  sockaddr_in address{};
  socklen_t address_size = sizeof(address);
  ssize_t size = -1;
  // A port that nobody listens on is reported to the next who receives; it is no datagram.
  for (int attempt = 0; attempt < 4 && size < 0; ++attempt) {
    size = recvfrom(descriptor_.get(), buffer_.data(), buffer_.size(), 0,
                    reinterpret_cast<sockaddr*>(&address), &address_size);
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      return std::nullopt;
    }
  }
  if (size < 0) {
    return std::nullopt;
  }
  return Received{fromSystem(address), Bytes(buffer_).first(static_cast<std::size_t>(size))};
}

std::uint16_t UdpSocket::port() const { return portOf(descriptor_); }

TcpStream::TcpStream(const Endpoint& server)
    : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)),
      state_(State::kConnecting) {
  if (descriptor_.get() < 0) {
    failure_ = std::strerror(errno);
    state_ = State::kClosed;
    return;
  }
  set(descriptor_, IPPROTO_TCP, TCP_NODELAY, 1);
  const sockaddr_in address = toSystem(server);
  if (connect(descriptor_.get(), generic(address), sizeof(address)) == 0) {
    state_ = State::kOpen;
  } else if (errno != EINPROGRESS) {
    close();
  }
}

TcpStream::TcpStream(Descriptor accepted) : descriptor_(std::move(accepted)), state_(State::kOpen) {
  set(descriptor_, IPPROTO_TCP, TCP_NODELAY, 1);
}

TcpStream::State TcpStream::state() {
  if (state_ == State::kConnecting) {
    sockaddr_in peer{};
    socklen_t size = sizeof(peer);
    int error = 0;
    socklen_t error_size = sizeof(error);
    getsockopt(descriptor_.get(), SOL_SOCKET, SO_ERROR, &error, &error_size);
    if (error != 0) {
      close();
    } else if (getpeername(descriptor_.get(), reinterpret_cast<sockaddr*>(&peer), &size) == 0) {
      state_ = State::kOpen;
    }
  }
  return state_;
}

bool TcpStream::send(Bytes bytes) {
  if (state_ != State::kOpen) {
    return false;
  }
  const ssize_t sent = ::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent != static_cast<ssize_t>(bytes.size())) {
    close();
  }
  return state_ == State::kOpen;
}

Bytes TcpStream::receive() {
  if (state_ != State::kOpen) {
    return {};
  }
  buffer_.resize(kLargestDatagram);
  const ssize_t size = recv(descriptor_.get(), buffer_.data(), buffer_.size(), 0);
  if (size > 0) {
    return Bytes(buffer_).first(static_cast<std::size_t>(size));
  }
  if (size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
    close();
  }
  return {};
}

void TcpStream::close() {
  descriptor_ = Descriptor();
  state_ = State::kClosed;
}

TcpListener::TcpListener(const std::string& what, Endpoint local)
    : descriptor_(makeSocket(what, SOCK_STREAM)) {
  bindTo(what, descriptor_, local);
  if (listen(descriptor_.get(), 8) != 0) {
    throw core::StartupError("network", what, "a port to listen on", std::strerror(errno));
  }
}

std::unique_ptr<TcpStream> TcpListener::accept() {
  const int accepted = accept4(descriptor_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  return accepted < 0 ? nullptr : std::make_unique<TcpStream>(Descriptor(accepted));
}

std::uint16_t TcpListener::port() const { return portOf(descriptor_); }

}  // namespace roundabout::mocap_bridge
