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
  /// Does not wait: nothing can arrive while the only thread is here.
  int handle(std::chrono::milliseconds timeout) override;

 private:
  struct Message {
    std::string channel;
    std::vector<std::byte> payload;
  };

  std::shared_ptr<MemoryNetwork> network_;
  std::multimap<std::string, Handler> handlers_;
  std::deque<Message> inbox_;
};

}  // namespace roundabout::bus
