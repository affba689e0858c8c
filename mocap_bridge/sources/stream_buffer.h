#pragma once

#include <vector>

#include "mocap_bridge/sources/byte_cursor.h"

namespace roundabout::mocap_bridge {

/// What has arrived of a stream and is not understood yet: never more than one message.
class StreamBuffer {
 public:
  void add(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  Bytes bytes() const { return bytes_; }
  /// Keeps only the last `count` bytes.
  void keep(std::size_t count) {
    bytes_.erase(bytes_.begin(), bytes_.end() - static_cast<std::ptrdiff_t>(count));
  }
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace roundabout::mocap_bridge
