#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"

typedef struct _lcm_t lcm_t;

namespace roundabout::bus {

/// The URL that a process uses: the explicit one, else LCM_DEFAULT_URL, else LCM's default group
/// with ttl 0 (this machine only). The one place that knows.
std::string resolveUrl(const std::string& explicit_url);

/// The URL with the largest receive buffer that this machine allows (net.core.rmem_max, at most 4
/// MiB), unless it says another. With the kernel's default, a burst of a hundred frames to a
/// process that is busy loses some.
std::string withLargeReceiveBuffer(const std::string& url);

/// A Bus over real LCM.
class LcmBus final : public Bus {
 public:
  /// Throws core::StartupError if the URL is malformed, the machine has no multicast route or the
  /// socket fails.
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  void publish(const std::string& channel, std::span<const std::byte> payload) override;
  void subscribe(const std::string& channel, Handler handler) override;
  void subscribePrefix(const std::string& prefix, Handler handler) override;
  int handle(std::chrono::milliseconds timeout) override;

  /// Becomes readable when a message is waiting; for poll() beside other descriptors.
  int fileDescriptor() const;

 private:
  struct Subscription;

  lcm_t* lcm_ = nullptr;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::exception_ptr pending_exception_;
};

}  // namespace roundabout::bus
