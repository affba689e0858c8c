#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "logs/reading/channel_filter.h"
#include "logs/reading/event_log.h"

namespace roundabout::logs {

struct PlayOptions {
  double speed = 1.0;   ///< times the pace of the recording
  double from_s = 0.0;  ///< of play time
  double to_s = std::numeric_limits<double>::infinity();
  bool loop = false;
  bool paused = false;
  bool data_clock = false;          ///< play time is that of the vehicle states, not the logger's
  std::vector<std::string> only;    ///< channels, as ChannelFilter takes them
  std::vector<std::string> except;  ///< channels
};

/// Plays a log: decides which events are due. Knows no clock and no wire: the caller says what time
/// it is and gets events to publish.
///
/// Play time is s since the first event. Times that go back, and gaps above ten minutes, take none,
/// so that a corrupt time stamp does not stop the play. Never more than kMostEvents or kMostBytes
/// at once: if more is due, the play is slower than asked for, and catches up with nothing.
class LogPlayer {
 public:
  using Publish = std::function<void(const Event&)>;

  static constexpr std::size_t kMostEvents = 20;       ///< the stock lcm-logger keeps 30
  static constexpr std::size_t kMostBytes = 48 << 10;  ///< but one event at least

  /// The log must outlive it. Throws core::StartupError if a channel's pattern is none.
  LogPlayer(const EventLog& log, const PlayOptions& options);

  /// Publishes what is due. wall_s: of a clock that does not go back. Call it every millisecond.
  void advance(double wall_s, const Publish& publish);
  /// s of wall clock until the next event; 0 if it is due, infinite if paused or at the end.
  double dueIn(double wall_s) const;

  void play(double wall_s);
  void pause(double wall_s);
  void setSpeed(double wall_s, double speed);
  /// The first event at or after this play time is next.
  void seek(double wall_s, double play_s);
  void setLoop(bool loop) { options_.loop = loop; }
  /// Up to and with the next event on VEHICLE_STATES, or on any channel of a log without them;
  /// then pauses.
  void step(double wall_s, const Publish& publish);

  bool paused() const { return options_.paused; }
  bool loop() const { return options_.loop; }
  double speed() const { return options_.speed; }
  /// Of the event played last, or where it was told to be.
  double positionS() const { return position_s_; }
  double endS() const;
  bool atEnd() const { return next_ >= end_; }
  std::size_t published() const { return published_; }

 private:
  double playS(std::size_t index) const;
  void anchor(double wall_s);
  double nowS(double wall_s) const;
  bool publishNext(const Publish& publish);

  const EventLog& log_;
  PlayOptions options_;
  ChannelFilter filter_;
  std::vector<core::Utime> times_;  // play time of each event, us; never goes back
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t next_ = 0;
  bool has_states_ = false;
  double anchor_wall_s_ = 0.0;
  double anchor_play_s_ = 0.0;
  bool anchored_ = false;
  double position_s_ = 0.0;
  std::size_t published_ = 0;
};

}  // namespace roundabout::logs
