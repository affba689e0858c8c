#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "common/core/time.h"

namespace roundabout::bus {

/// One received message, valid during the handler's call.
struct Received {
  std::string_view channel;
  std::span<const std::byte> payload;
  core::Utime recv_utime = 0;  ///< us, wall clock of arrival
};

/// LCM's services behind a small interface. One thread at a time may use an object.
class Bus {
 public:
  using Handler = std::function<void(const Received&)>;

  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  virtual void publish(const std::string& channel, std::span<const std::byte> payload) = 0;

  /// The channel is a name, not a pattern. Handlers run inside handle(), in order of arrival; an
  /// exception that leaves one is kept while LCM's C code is on the stack and leaves handle()
  /// instead.
  virtual void subscribe(const std::string& channel, Handler handler) = 0;

  /// As subscribe(), for every channel whose name begins so: for tools that do not know who flies.
  virtual void subscribePrefix(const std::string& prefix, Handler handler) = 0;

  /// Waits until a message is there or the time is up, then runs the handlers of everything that
  /// has arrived. Returns the number of messages handled.
  virtual int handle(std::chrono::milliseconds timeout) = 0;
};

}  // namespace roundabout::bus
