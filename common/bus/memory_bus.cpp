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
    if (std::any_of(member->subscriptions_.begin(), member->subscriptions_.end(),
                    [&](const Subscription& own) { return own.hears(channel); })) {
      member->inbox_.push_back({channel, {payload.begin(), payload.end()}});
    }
  }
}

void MemoryBus::subscribe(const std::string& channel, Handler handler) {
  subscriptions_.push_back({channel, false, std::move(handler)});
}

void MemoryBus::subscribePrefix(const std::string& prefix, Handler handler) {
  subscriptions_.push_back({prefix, true, std::move(handler)});
}

int MemoryBus::handle(std::chrono::milliseconds /*timeout*/) {
  int handled = 0;
  while (!inbox_.empty()) {
    const Message message = std::move(inbox_.front());
    inbox_.pop_front();
    for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
      if (subscriptions_[i].hears(message.channel)) {
        subscriptions_[i].handler({message.channel, message.payload, 0});
      }
    }
    ++handled;
  }
  return handled;
}

}  // namespace roundabout::bus
