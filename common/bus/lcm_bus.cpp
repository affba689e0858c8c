#include "common/bus/lcm_bus.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <regex>
#include <utility>

#include <arpa/inet.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::bus {

namespace {

constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";
// Messages that a subscription keeps while its process is busy. LCM drops the newest when it is
// full; at 200 Hz this lasts five seconds, longer than any watchdog.
constexpr int kQueueCapacity = 1000;

// LCM prints a page and returns an unusable object when there is no multicast route: find out
// before it does.
void checkMulticastRoute(const std::string& url) {
  static const std::regex kUdpm(R"(udpm://(?:([0-9.]+)(?::([0-9]{1,5}))?)?(?:\?.*)?)");
  std::smatch match;
  if (!std::regex_match(url, match, kUdpm)) {
    throw core::StartupError("lcm_url", url, "udpm://ADDRESS:PORT?ttl=N", "something else");
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const std::string group = match[1].matched ? match[1].str() : "239.255.76.67";
  const int port = match[2].matched ? std::atoi(match[2].str().c_str()) : 7667;
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(address.sin_addr.s_addr)) || port < 1 || port > 65535) {
    throw core::StartupError("lcm_url", url, "a multicast address and a port from 1 to 65535",
                             group + ":" + std::to_string(port));
  }
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool reachable =
      descriptor >= 0 &&
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  const int error = errno;
  if (descriptor >= 0) {
    close(descriptor);
  }
  if (!reachable) {
    throw core::StartupError(
        "lcm_url", url, "a multicast route to " + group,
        std::string(std::strerror(error)) +
            " (try: sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo)");
  }
}

}  // namespace

std::string resolveUrl(const std::string& explicit_url) {
  if (!explicit_url.empty()) {
    return explicit_url;
  }
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  return from_environment != nullptr && *from_environment != '\0' ? from_environment : kDefaultUrl;
}

std::string withLargeReceiveBuffer(const std::string& url) {
  constexpr long kEnough = 4L << 20;
  if (url.find("recv_buf_size=") != std::string::npos) {
    return url;
  }
  long allowed = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> allowed;
  if (allowed <= 0) {
    return url;
  }
  return fmt::format("{}{}recv_buf_size={}", url, url.find('?') == std::string::npos ? "?" : "&",
                     std::min(allowed, kEnough));
}

struct LcmBus::Subscription {
  LcmBus* bus;
  Handler handler;

  static void onMessage(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
    auto* self = static_cast<Subscription*>(user);
    if (self->bus->pending_exception_) {
      return;
    }
    try {
      self->handler({channel,
                     {static_cast<const std::byte*>(buffer->data), buffer->data_size},
                     buffer->recv_utime});
    } catch (...) {
      self->bus->pending_exception_ = std::current_exception();
    }
  }
};

LcmBus::LcmBus(const std::string& url) {
  checkMulticastRoute(url);
  lcm_ = lcm_create(withLargeReceiveBuffer(url).c_str());
  if (lcm_ == nullptr) {
    throw core::StartupError("lcm_url", url, "a socket that LCM can open", std::strerror(errno));
  }
}

LcmBus::~LcmBus() { lcm_destroy(lcm_); }

void LcmBus::publish(const std::string& channel, std::span<const std::byte> payload) {
  lcm_publish(lcm_, channel.c_str(), payload.data(), static_cast<unsigned>(payload.size()));
}

void LcmBus::subscribe(const std::string& channel, Handler handler) {
  auto& subscription = subscriptions_.emplace_back(
      std::make_unique<Subscription>(Subscription{this, std::move(handler)}));
  lcm_subscription_t* handle =
      lcm_subscribe(lcm_, channel.c_str(), &Subscription::onMessage, subscription.get());
  if (handle == nullptr) {
    throw core::StartupError("lcm_url", channel, "a subscription", "refused by LCM");
  }
  lcm_subscription_set_queue_capacity(handle, kQueueCapacity);
}

// Names of channels are letters, digits and underscore only, so that LCM's patterns match them as
// they are.
void LcmBus::subscribePrefix(const std::string& prefix, Handler handler) {
  subscribe(prefix + ".*", std::move(handler));
}

int LcmBus::handle(std::chrono::milliseconds timeout) {
  int handled = 0;
  auto wait = static_cast<int>(timeout.count());
  while (handled < kQueueCapacity && lcm_handle_timeout(lcm_, wait) > 0) {
    if (pending_exception_) {
      std::rethrow_exception(std::exchange(pending_exception_, nullptr));
    }
    ++handled;
    wait = 0;
  }
  return handled;
}

int LcmBus::fileDescriptor() const { return lcm_get_fileno(lcm_); }

}  // namespace roundabout::bus
