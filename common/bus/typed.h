#pragma once

// Typed publish and subscribe over the byte interface, for the types that lcm-gen makes.

#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/plausible.h"

namespace roundabout::bus {

template <class Message>
std::vector<std::byte> encode(const Message& message) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Why bytes did not become a message.
struct DecodeError {
  std::string_view channel;
  const char* reason;
};

/// Decodes a whole payload; returns a reason on failure and nullptr on success. Never throws, and
/// allocates no more than the payload can hold: lcm-gen's own decode() resizes to whatever count
/// the bytes claim.
template <class Message>
const char* decode(std::span<const std::byte> payload, Message& message) {
  if (payload.size() < sizeof(std::int64_t)) {
    return "shorter than a fingerprint";
  }
  if (fingerprintOf(payload) != static_cast<std::uint64_t>(Message::getHash())) {
    return "wrong fingerprint";
  }
  if (!plausibleCounts<Message>(payload)) {
    return "counts larger than the message";
  }
  try {
    const int used = message.decode(payload.data(), 0, static_cast<int>(payload.size()));
    if (used < 0) {
      return "truncated";
    }
    return static_cast<std::size_t>(used) == payload.size() ? nullptr : "bytes left over";
  } catch (const std::exception&) {
    return "corrupt";
  }
}

template <class Message>
void publish(Bus& bus, const std::string& channel, const Message& message) {
  bus.publish(channel, encode(message));
}

/// on_error sees every payload that is not a Message.
template <class Message>
Bus::Handler decoding(std::function<void(const Message&)> on_message,
                      std::function<void(const DecodeError&)> on_error) {
  return [on_message = std::move(on_message), on_error = std::move(on_error),
          message = Message()](const Received& received) mutable {
    if (const char* reason = decode(received.payload, message)) {
      on_error({received.channel, reason});
    } else {
      on_message(message);
    }
  };
}

template <class Message>
void subscribe(Bus& bus, const std::string& channel, std::function<void(const Message&)> on_message,
               std::function<void(const DecodeError&)> on_error) {
  bus.subscribe(channel, decoding<Message>(std::move(on_message), std::move(on_error)));
}

template <class Message>
void subscribePrefix(Bus& bus, const std::string& prefix,
                     std::function<void(const Message&)> on_message,
                     std::function<void(const DecodeError&)> on_error) {
  bus.subscribePrefix(prefix, decoding<Message>(std::move(on_message), std::move(on_error)));
}

}  // namespace roundabout::bus
