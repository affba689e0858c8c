#include "logs/replay/log_player.h"

#include <algorithm>

#include "common/bus/messages.h"
#include "common/bus/plausible.h"
#include "common/core/error.h"

namespace roundabout::logs {

namespace {

constexpr core::Utime kLongestGap = 600 * core::kMicrosPerSecond;

/// The utime of a vehicle_states_t; 0 for any other event.
core::Utime dataUtime(const Event& event) {
  return event.channel == bus::kStatesChannel && event.payload.size() >= 16
             ? static_cast<core::Utime>(bus::bigEndian(event.payload, 8, 8))
             : 0;
}

}  // namespace

LogPlayer::LogPlayer(const EventLog& log, const PlayOptions& options)
    : log_(log), options_(options), filter_(options.only, options.except) {
  times_.reserve(log.size());
  core::Utime play = 0;
  core::Utime last = options.data_clock ? 0 : log.logUtime(0);
  for (std::size_t i = 0; i < log.size(); ++i) {
    const core::Utime utime = options.data_clock ? dataUtime(log[i]) : log.logUtime(i);
    if (utime > 0) {
      const core::Utime passed = last == 0 ? 0 : utime - last;
      play += passed > 0 && passed <= kLongestGap ? passed : 0;
      last = utime;
    }
    times_.push_back(play);
    has_states_ = has_states_ || log[i].channel == bus::kStatesChannel;
  }
  const auto at = [&](double seconds) {
    const auto found = std::partition_point(times_.begin(), times_.end(), [&](core::Utime time) {
      return core::toSeconds(time) < seconds;
    });
    return static_cast<std::size_t>(found - times_.begin());
  };
  begin_ = at(options.from_s);
  end_ = at(options.to_s);
  next_ = begin_;
  position_s_ = begin_ < log.size() ? playS(begin_) : endS();
}

double LogPlayer::playS(std::size_t index) const { return core::toSeconds(times_[index]); }

double LogPlayer::endS() const { return end_ == 0 ? 0.0 : playS(end_ - 1); }

void LogPlayer::anchor(double wall_s) {
  anchored_ = true;
  anchor_wall_s_ = wall_s;
  anchor_play_s_ = position_s_;
}

double LogPlayer::nowS(double wall_s) const {
  return anchor_play_s_ + options_.speed * (wall_s - anchor_wall_s_);
}

bool LogPlayer::publishNext(const Publish& publish) {
  const Event event = log_[next_];
  position_s_ = playS(next_);
  ++next_;
  if (!filter_.passes(event.channel)) {
    return false;
  }
  publish(event);
  ++published_;
  return true;
}

void LogPlayer::advance(double wall_s, const Publish& publish) {
  if (!anchored_) {
    anchor(wall_s);
  }
  if (options_.paused) {
    return;
  }
  if (atEnd() && options_.loop && begin_ < end_) {
    seek(wall_s, playS(begin_));
  }
  std::size_t events = 0;
  std::size_t bytes = 0;
  const double now_s = nowS(wall_s);
  while (!atEnd() && playS(next_) <= now_s) {
    const std::size_t size = log_[next_].payload.size();
    if (events == kMostEvents || (events > 0 && bytes + size > kMostBytes)) {
      position_s_ = playS(next_);
      anchor(wall_s);
      return;
    }
    if (publishNext(publish)) {
      ++events;
      bytes += size;
    }
  }
}

double LogPlayer::dueIn(double wall_s) const {
  if (options_.paused || (atEnd() && !options_.loop)) {
    return std::numeric_limits<double>::infinity();
  }
  return atEnd() || !anchored_ ? 0.0
                               : std::max(0.0, (playS(next_) - nowS(wall_s)) / options_.speed);
}

void LogPlayer::play(double wall_s) {
  if (options_.paused) {
    options_.paused = false;
    anchor(wall_s);
  }
}

void LogPlayer::pause(double wall_s) {
  if (!options_.paused) {
    position_s_ = atEnd() ? endS() : std::min(nowS(wall_s), playS(next_));
    options_.paused = true;
  }
}

void LogPlayer::setSpeed(double wall_s, double speed) {
  if (!options_.paused && anchored_) {
    position_s_ = atEnd() ? endS() : std::min(nowS(wall_s), playS(next_));
  }
  options_.speed = speed;
  anchor(wall_s);
}

void LogPlayer::seek(double wall_s, double play_s) {
  const auto first = times_.begin() + static_cast<std::ptrdiff_t>(begin_);
  const auto last = times_.begin() + static_cast<std::ptrdiff_t>(end_);
  const auto found = std::lower_bound(first, last, core::toUtime(std::max(play_s, 0.0)));
  next_ = static_cast<std::size_t>(found - times_.begin());
  position_s_ = atEnd() ? endS() : playS(next_);
  anchor(wall_s);
}

void LogPlayer::step(double wall_s, const Publish& publish) {
  options_.paused = true;
  while (!atEnd()) {
    const bool last = !has_states_ || log_[next_].channel == bus::kStatesChannel;
    const bool published = publishNext(publish);
    if (last && (published || has_states_)) {
      break;
    }
  }
  anchor(wall_s);
}

}  // namespace roundabout::logs
