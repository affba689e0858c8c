#pragma once

#include <functional>
#include <string>

#include "common/bus/bus.h"

namespace roundabout::perception {

/// Somebody else's bus on which a node hears everything and says nothing: what it publishes goes to
/// a function.
class SilentBus final : public bus::Bus {
 public:
  using Said = std::function<void(const std::string& channel)>;

  SilentBus(bus::Bus& heard, Said said) : heard_(heard), said_(std::move(said)) {}

  void publish(const std::string& channel, std::span<const std::byte> /*payload*/) override {
    said_(channel);
  }
  void subscribe(const std::string& channel, Handler handler) override {
    heard_.subscribe(channel, std::move(handler));
  }
  void subscribePrefix(const std::string& prefix, Handler handler) override {
    heard_.subscribePrefix(prefix, std::move(handler));
  }
  int handle(std::chrono::milliseconds timeout) override { return heard_.handle(timeout); }

 private:
  bus::Bus& heard_;
  Said said_;
};

}  // namespace roundabout::perception
