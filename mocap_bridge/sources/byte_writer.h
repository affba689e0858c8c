#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mocap_bridge/sources/byte_cursor.h"

namespace roundabout::mocap_bridge {

/// The other direction of ByteCursor.
template <std::endian kOrder>
class ByteWriter {
 public:
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void put(Number value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(Number));
    set(at, value);
  }

  /// Overwrites a number that was put at that position.
  template <class Number>
  void set(std::size_t at, Number value) {
    std::byte raw[sizeof(Number)];
    std::memcpy(raw, &value, sizeof(Number));
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      bytes_[at + i] = raw[kOrder == std::endian::native ? i : sizeof(Number) - 1 - i];
    }
  }

  void put(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  /// With a NUL at its end.
  void putText(std::string_view text) {
    put(bytesOf(text));
    bytes_.push_back(std::byte{0});
  }

  /// Cut or padded with zeros to the size of the field.
  void putText(std::string_view text, std::size_t field_bytes) {
    const std::size_t end = bytes_.size() + field_bytes;
    put(bytesOf(text.substr(0, field_bytes)));
    bytes_.resize(end);
  }

  std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }
  void resize(std::size_t size) { bytes_.resize(size); }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

using LittleEndianWriter = ByteWriter<std::endian::little>;
using BigEndianWriter = ByteWriter<std::endian::big>;

}  // namespace roundabout::mocap_bridge
