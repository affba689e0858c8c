#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>

#include "common/config/experiment.h"
#include "common/core/time.h"
#include "mocap_bridge/sources/byte_cursor.h"
#include "mocap_bridge/sources/frame_sequence.h"
#include "mocap_bridge/sources/source_frame.h"

namespace roundabout::mocap_bridge {

/// One packet, and between which ports it went.
struct Packet {
  core::Utime received = 0;  ///< us, local clock
  std::uint16_t from_port = 0;
  std::uint16_t to_port = 0;
  Bytes payload;  ///< a datagram, or the next bytes of a stream
};

/// What has happened in a session so far.
struct SourceCounters {
  std::int64_t packets = 0;
  std::int64_t frames = 0;
  std::int64_t malformed = 0;     ///< packets that could not be understood
  std::int64_t wrong_sender = 0;  ///< from another machine than the server
  std::int64_t lost_frames = 0;   ///< missing in the system's numbers
  std::int64_t old_frames = 0;    ///< doubled or overtaken: not used
  std::int64_t bad_stamps = 0;    ///< exposed in the future or long ago: not used
  std::int64_t restarts = 0;      ///< of the server, or of its numbers
};

/// Understands what one system sends, without sockets: a session feeds it live, a replay from a
/// file. Whatever it is fed, it neither throws nor allocates more than the packet's size allows.
class Interpreter {
 public:
  virtual ~Interpreter() = default;
  virtual void onPacket(const Packet& packet, PacketSink& sink) = 0;
  /// Of streams: another connection begins, of which the next packet is the first.
  virtual void onConnection() {}
  /// Of streams: bytes are missing before the next packet, which may begin with a message.
  virtual void onGap() {}
  /// Names of what is streamed, as far as it has been said.
  virtual std::vector<std::string> bodies() const = 0;
  /// Of the protocol, as the system said it; empty: it did not.
  virtual std::string version() const { return {}; }
  const SourceCounters& counters() const { return counters_; }
  /// From now on every frame is shown, doubled and overtaken ones too, whatever its stamps.
  void showEverything() { everything_ = true; }

 protected:
  /// True if a frame of that number is to be shown; counts it if not, and what is missing where
  /// numbers count frames.
  bool admits(std::int64_t number, bool& restarted, bool numbers_count = true) {
    restarted = false;
    switch (sequence_.judge(number)) {
      case FrameSequence::Verdict::kOld:
        ++counters_.old_frames;
        return everything_;
      case FrameSequence::Verdict::kRestart:
        ++counters_.restarts;
        restarted = true;
        return true;
      case FrameSequence::Verdict::kNext:
        counters_.lost_frames += numbers_count ? sequence_.lost() : 0;
        return true;
    }
    return true;
  }
  /// True if a frame with that exposure is to be shown; counts it if not.
  bool admits(const std::optional<core::Utime>& exposure) {
    counters_.bad_stamps += exposure ? 0 : 1;
    return exposure || everything_;
  }
  bool showsEverything() const { return everything_; }

  SourceCounters counters_;

 private:
  FrameSequence sequence_;
  bool everything_ = false;
};

struct SourceStatus {
  bool connected = false;           ///< the server has answered and is not silent
  std::string server;               ///< "Motive 2.1.0.0, NatNet 3.0, at 192.168.0.106"
  std::vector<std::string> bodies;  ///< what it streams, as far as it has said
  SourceCounters counters;
};

/// Lines for the log, each kind once until it is over.
class Notes {
 public:
  void once(const std::string& kind, const std::string& text) {
    if (std::exchange(said_[kind], true) == false) {
      pending_.push_back(text);
    }
  }
  /// That kind may be said again; `text`, if there is one, says that it is over. Whether it was
  /// said.
  bool over(const std::string& kind, const std::string& text = {}) {
    const auto found = said_.find(kind);
    const bool was_said = found != said_.end() && std::exchange(found->second, false);
    if (was_said && !text.empty()) {
      pending_.push_back(text);
    }
    return was_said;
  }
  void say(const std::string& text) { pending_.push_back(text); }
  std::vector<std::string> take() { return std::exchange(pending_, {}); }

 private:
  std::map<std::string, bool> said_;
  std::vector<std::string> pending_;
};

/// A session with one motion-capture system: sockets, handshake, keep-alive, reconnection. It never
/// blocks and knows the time only from its caller.
class Source {
 public:
  using Tap = std::function<void(const Packet&)>;

  virtual ~Source() = default;

  /// Handles what has arrived and what is due. `now`: us, a local clock that does not jump. Sockets
  /// that fail are a note and are opened again.
  virtual void poll(core::Utime now, PacketSink& sink) = 0;
  /// What to wait for beside the next 20 ms.
  virtual void addDescriptors(std::vector<pollfd>& descriptors) const = 0;
  virtual SourceStatus status() const = 0;
  /// There will be nothing more: the end of a recording.
  virtual bool finished() const { return false; }
  /// The time of the data that is due now: that of a recording is another one.
  virtual core::Utime dataTime(core::Utime now) const { return now; }

  std::vector<std::string> takeNotes() { return notes_.take(); }
  /// Sees every packet as it arrives; of a stream an empty one when a connection begins.
  void setTap(Tap tap) { tap_ = std::move(tap); }
  /// A clock to be read after each packet was taken, on the time of poll()'s `now`. A process that
  /// is held up between reading the clock and the socket would else find packets that arrived
  /// before they were sent, which the shortest of all delays would be learned from.
  void setArrivalClock(std::function<core::Utime()> clock) { arrival_clock_ = std::move(clock); }

 protected:
  /// Not before the packet that was just taken arrived.
  core::Utime arrivalTime(core::Utime now) const {
    return arrival_clock_ ? std::max(now, arrival_clock_()) : now;
  }

  /// For sessions over a stream, whose next bytes these are.
  void tapStream(const Packet& packet) {
    if (tap_ && std::exchange(connection_begins_, false)) {
      tap_({packet.received, packet.from_port, packet.to_port, {}});
    }
    if (tap_) {
      tap_(packet);
    }
  }
  void noteConnection() { connection_begins_ = true; }

  Notes notes_;
  Tap tap_;

 private:
  bool connection_begins_ = false;
  std::function<core::Utime()> arrival_clock_;
};

}  // namespace roundabout::mocap_bridge
