#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace roundabout::mocap_bridge {

using Bytes = std::span<const std::byte>;

inline Bytes bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

/// Reads numbers and texts off bytes that nobody vouches for. What would lie beyond the end reads
/// as zero or empty and makes the cursor fail for good, so that a parser asks once, at its end.
template <std::endian kOrder>
class ByteCursor {
 public:
  explicit ByteCursor(Bytes bytes) : bytes_(bytes) {}

  bool failed() const { return failed_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  std::size_t position() const { return at_; }
  void fail() {
    failed_ = true;
    at_ = bytes_.size();
  }

  template <class Number>
  requires std::is_arithmetic_v<Number> Number read() {
    std::byte raw[sizeof(Number)] = {};
    if (remaining() < sizeof(Number)) {
      fail();
      return Number{};
    }
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      raw[kOrder == std::endian::native ? i : sizeof(Number) - 1 - i] = bytes_[at_ + i];
    }
    at_ += sizeof(Number);
    Number value;
    std::memcpy(&value, raw, sizeof(Number));
    return value;
  }

  Bytes take(std::size_t count) {
    if (remaining() < count) {
      fail();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  void skip(std::size_t count) { take(count); }

  /// count items of that many bytes each, however large the count claims to be.
  void skipItems(std::uint64_t count, std::size_t item_bytes) {
    if (count > remaining() / item_bytes) {
      fail();
    } else {
      skip(static_cast<std::size_t>(count) * item_bytes);
    }
  }

  /// How many items follow; fails unless so many of at least that size fit into what is left.
  std::size_t readCount(std::size_t least_item_bytes) {
    const auto count = read<std::int32_t>();
    if (count < 0 || static_cast<std::size_t>(count) > remaining() / least_item_bytes) {
      fail();
      return 0;
    }
    return static_cast<std::size_t>(count);
  }

  /// Text up to its NUL, which has to be there.
  std::string_view readText() {
    const Bytes left = bytes_.subspan(at_);
    if (left.empty()) {
      fail();
      return {};
    }
    const void* end = std::memchr(left.data(), 0, left.size());
    if (end == nullptr) {
      fail();
      return {};
    }
    const auto length = static_cast<std::size_t>(static_cast<const std::byte*>(end) - left.data());
    at_ += length + 1;
    return {reinterpret_cast<const char*>(left.data()), length};
  }

  /// Text in a field of fixed size, up to its first NUL if it has one.
  std::string_view readText(std::size_t field_bytes) {
    const Bytes field = take(field_bytes);
    const std::string_view text(reinterpret_cast<const char*>(field.data()), field.size());
    return text.substr(0, text.find('\0'));
  }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

using LittleEndianCursor = ByteCursor<std::endian::little>;
using BigEndianCursor = ByteCursor<std::endian::big>;

}  // namespace roundabout::mocap_bridge
