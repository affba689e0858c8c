#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace roundabout::planner {

/// One field of a serialised protocol buffer, undecoded.
struct WireField {
  std::uint64_t number = 0;
  std::uint64_t value = 0;  ///< of a varint, fixed32 or fixed64 field
  std::string_view bytes;   ///< of a length-delimited field; within the message
};

/// The fields of a message in their order (protobuf.dev, "Encoding"); nothing if it is malformed.
std::optional<std::vector<WireField>> parseMessage(std::string_view message);

}  // namespace roundabout::planner
