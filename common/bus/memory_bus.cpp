#include "common/bus/memory_bus.h"

#include <algorithm>

namespace roundabout::bus {

int MemoryNetwork::published(const std::string& channel) const {
  const auto found = published_.find(channel);
  return found == published_.end() ? 0 : found->second;
}

MemoryBus::MemoryBus(std::shared_ptr<MemoryNetwork> network) : network_(std::move(network)) {
  network_->members_.push_back(this);
}

MemoryBus::~MemoryBus() { std::erase(network_->members_, this); }

void MemoryBus::publish(const std::string& channel, std::span<const std::byte> payload) {
  ++network_->published_[channel];
  for (MemoryBus* member : network_->members_) {
    if (member->handlers_.contains(channel)) {
      member->inbox_.push_back({channel, {payload.begin(), payload.end()}});
    }
  }
}

void MemoryBus::subscribe(const std::string& channel, Handler handler) {
  handlers_.emplace(channel, std::move(handler));
}

int MemoryBus::handle(std::chrono::milliseconds /*timeout*/) {
  int handled = 0;
  while (!inbox_.empty()) {
    const Message message = std::move(inbox_.front());
    inbox_.pop_front();
    const auto [begin, end] = handlers_.equal_range(message.channel);
    for (auto it = begin; it != end; ++it) {
      it->second({message.channel, message.payload, 0});
    }
    ++handled;
  }
  return handled;
}

}  // namespace roundabout::bus
