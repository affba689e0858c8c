#pragma once

#include <cstdint>
#include <optional>

#include "mocap_bridge/sources/source_frame.h"

namespace roundabout::mocap_bridge {

/// Puts frames together that come in parts with a common key (number or stamp). A frame is complete
/// when it has as many bodies as the one before, or at the first part of the next.
class FrameAssembler {
 public:
  /// The frame so far, if that part begins another: to be sent first.
  std::optional<SourceFrame> begin(std::int64_t key) {
    if (open_ && key == key_) {
      return std::nullopt;
    }
    std::optional<SourceFrame> unsent;
    if (open_) {
      expected_ = frame_.bodies.size();
      if (!sent_) {
        unsent = frame_;
      }
    }
    open_ = true;
    sent_ = false;
    key_ = key;
    frame_.bodies.clear();
    return unsent;
  }

  SourceFrame& frame() { return frame_; }
  const SourceFrame& frame() const { return frame_; }

  /// True once a frame: it has all its bodies.
  bool complete() {
    if (sent_ || expected_ == 0 || frame_.bodies.size() < expected_) {
      return false;
    }
    sent_ = true;
    return true;
  }

 private:
  SourceFrame frame_;
  std::int64_t key_ = 0;
  bool open_ = false;
  bool sent_ = false;
  std::size_t expected_ = 0;
};

}  // namespace roundabout::mocap_bridge
