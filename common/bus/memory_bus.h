#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace roundabout::bus {

class MemoryBus;

/// What several MemoryBus objects talk over, as processes talk over one multicast group. For tests;
/// one thread.
class MemoryNetwork {
 public:
  /// Counts messages that have been published and kept by nobody's subscription too.
  int published(const std::string& channel) const;

 private:
  friend class MemoryBus;
  std::vector<MemoryBus*> members_;
  std::map<std::string, int> published_;
};

/// LcmBus's twin in memory: the same order, the same copies, no wire. A publisher hears itself, as
/// on LCM.
class MemoryBus final : public Bus {
 public:
  explicit MemoryBus(std::shared_ptr<MemoryNetwork> network);
  ~MemoryBus() override;

  void publish(const std::string& channel, std::span<const std::byte> payload) override;
  void subscribe(const std::string& channel, Handler handler) override;
  void subscribePrefix(const std::string& prefix, Handler handler) override;
  /// Does not wait: nothing can arrive while the only thread is here.
  int handle(std::chrono::milliseconds timeout) override;

 private:
  struct Message {
    std::string channel;
    std::vector<std::byte> payload;
  };
  struct Subscription {
    std::string name;
    bool prefix;
    Handler handler;

    bool hears(const std::string& channel) const {
      return prefix ? channel.starts_with(name) : channel == name;
    }
  };

  std::shared_ptr<MemoryNetwork> network_;
  std::deque<Subscription> subscriptions_;  // a handler may add to them
  std::deque<Message> inbox_;
};

}  // namespace roundabout::bus
