#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "logs/types/message_type.h"

namespace roundabout::logs {

/// In quotes, with whatever JSON needs escaped; bytes that are no UTF-8 become U+FFFD.
std::string jsonString(std::string_view text);

/// Appends a message as one JSON object on one line: members by name, lists as arrays, lists of
/// bytes in base64, numbers that are not finite as null. Returns as walk() does; on failure the
/// text is as it was.
const char* appendJson(const MessageType& type, std::span<const std::byte> payload,
                       std::string& text);

/// The JSON schema (draft 2020-12) of what appendJson() writes. Comments and units of the .lcm file
/// become descriptions.
std::string jsonSchema(const MessageType& type);

}  // namespace roundabout::logs
