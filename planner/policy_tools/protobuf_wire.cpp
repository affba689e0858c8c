#include "planner/policy_tools/protobuf_wire.h"

namespace roundabout::planner {

namespace {

enum WireType : std::uint64_t { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

/// All take what they read off the front of `rest`.
std::optional<std::uint64_t> takeVarint(std::string_view& rest) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && !rest.empty(); shift += 7) {
    const auto byte = static_cast<unsigned char>(rest.front());
    rest.remove_prefix(1);
    value |= std::uint64_t{byte & 0x7fU} << shift;
    if ((byte & 0x80U) == 0) {
      return value;
    }
  }
  return std::nullopt;
}

std::optional<std::string_view> takeBytes(std::string_view& rest, std::uint64_t count) {
  if (count > rest.size()) {
    return std::nullopt;
  }
  const std::string_view taken = rest.substr(0, count);
  rest.remove_prefix(count);
  return taken;
}

std::optional<std::uint64_t> takeFixed(std::string_view& rest, std::uint64_t count) {
  const auto bytes = takeBytes(rest, count);
  if (!bytes) {
    return std::nullopt;
  }
  std::uint64_t value = 0;
  for (auto byte = bytes->rbegin(); byte != bytes->rend(); ++byte) {
    value = value << 8 | static_cast<unsigned char>(*byte);
  }
  return value;
}

bool takeContent(std::string_view& rest, std::uint64_t wire_type, WireField& field) {
  std::optional<std::uint64_t> value;
  switch (wire_type) {
    case kVarint:
      value = takeVarint(rest);
      break;
    case kFixed64:
      value = takeFixed(rest, 8);
      break;
    case kFixed32:
      value = takeFixed(rest, 4);
      break;
    case kLengthDelimited:
      if (const auto length = takeVarint(rest)) {
        const auto bytes = takeBytes(rest, *length);
        field.bytes = bytes.value_or(std::string_view{});
        return bytes.has_value();
      }
      return false;
    default:
      return false;
  }
  field.value = value.value_or(0);
  return value.has_value();
}

}  // namespace

std::optional<std::vector<WireField>> parseMessage(std::string_view message) {
  std::vector<WireField> fields;
  while (!message.empty()) {
    const auto key = takeVarint(message);
    if (!key) {
      return std::nullopt;
    }
    WireField& field = fields.emplace_back();
    field.number = *key >> 3;
    if (!takeContent(message, *key & 7U, field)) {
      return std::nullopt;
    }
  }
  return fields;
}

}  // namespace roundabout::planner
