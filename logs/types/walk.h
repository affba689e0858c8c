#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "logs/types/message_type.h"

namespace roundabout::logs {

/// Sees the values of a message in their order on the wire.
class MessageVisitor {
 public:
  virtual ~MessageVisitor() = default;

  /// Before the value, or the list, of each member.
  virtual void member(const Member& member) = 0;
  virtual void integer(std::int64_t value) = 0;
  /// May be NaN or infinite. digits: significant decimal digits that tell the value from others.
  virtual void real(double value, int digits) = 0;
  virtual void boolean(bool value) = 0;
  virtual void text(std::string_view value) = 0;
  /// A whole list of bytes.
  virtual void bytes(std::span<const std::byte> value) = 0;
  /// A list of anything else.
  virtual void beginList(std::size_t count) = 0;
  virtual void endList() = 0;
  virtual void beginMessage(const MessageType& type) = 0;
  virtual void endMessage() = 0;
};

/// Decodes a whole payload, fingerprint first, whose type is known; the outermost message is not
/// announced. Returns a reason on failure, when the visitor has seen what was before it, and
/// nullptr on success. Never throws but for the visitor; believes no count that the payload is too
/// short for.
const char* walk(const MessageType& type, std::span<const std::byte> payload,
                 MessageVisitor& visitor);

}  // namespace roundabout::logs
