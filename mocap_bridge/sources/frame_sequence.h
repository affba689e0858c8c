#pragma once

#include <cstdint>
#include <limits>

namespace roundabout::mocap_bridge {

/// Judges frames by the system's own numbers. Numbers that are not larger than the last are
/// refused, unless three of them grow: then the system was started anew or plays from its start.
/// Between those, packets may come doubled, or overtaken by a few.
class FrameSequence {
 public:
  enum class Verdict { kNext, kOld, kRestart };

  Verdict judge(std::int64_t number) {
    lost_ = 0;
    if (!started_ || number > last_) {
      lost_ = started_ ? number - last_ - 1 : 0;
      accept(number);
      return Verdict::kNext;
    }
    if (agreeing_ > 0 && number <= candidate_ && candidate_ - number < kOvertaken) {
      return Verdict::kOld;
    }
    const bool grows = agreeing_ > 0 && number > candidate_;
    agreeing_ = grows ? agreeing_ + 1 : 1;
    candidate_ = number;
    if (agreeing_ < kAgreeing) {
      return Verdict::kOld;
    }
    accept(number);
    return Verdict::kRestart;
  }

  /// Frames between the last two accepted ones.
  std::int64_t lost() const { return lost_; }

 private:
  static constexpr int kAgreeing = 3;
  static constexpr std::int64_t kOvertaken = 16;

  void accept(std::int64_t number) {
    started_ = true;
    last_ = number;
    agreeing_ = 0;
  }

  bool started_ = false;
  std::int64_t last_ = 0;
  std::int64_t candidate_ = 0;
  std::int64_t lost_ = 0;
  int agreeing_ = 0;
};

}  // namespace roundabout::mocap_bridge
