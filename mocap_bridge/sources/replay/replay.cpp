#include "mocap_bridge/sources/replay/replay.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

namespace {

// Of a packet whose recording does not say it; a frame's interval at 200 Hz.
constexpr core::Utime kInterval = 5'000;

struct CountingSink final : PacketSink {
  explicit CountingSink(PacketSink& sink) : to(sink) {}
  void onFrame(const SourceFrame& frame) override {
    ++frames;
    to.onFrame(frame);
  }
  void onPacket(const PacketFacts& facts) override { to.onPacket(facts); }

  PacketSink& to;
  int frames = 0;
};

}  // namespace

ReplaySource::ReplaySource(const config::Mocap& mocap) : speed_(mocap.speed), file_(mocap.file) {
  if (mocap.file.empty()) {
    throw core::StartupError("mocap", "file", "the recording that source: replay plays", "nothing");
  }
  if (looksLikeEventLog(mocap.file)) {
    frames_ = readStatesOfLog(mocap.file);
    for (const SourceFrame& frame : frames_) {
      times_.push_back(frame.exposure_utime);
    }
  } else {
    packets_ = readPacketFile(mocap.file);
    const Protocol& protocol = protocolNamed(mocap.protocol);
    interpreter_ = protocol.make_interpreter(mocap);
    feed_.emplace(protocol, mocap, packets_);
    core::Utime latest = 0;
    for (StoredPacket& packet : packets_.packets) {
      latest = packet.received == 0 ? latest + kInterval : std::max(latest, packet.received);
      packet.received = latest;
      times_.push_back(latest);
    }
  }
  if (times_.empty()) {
    throw core::StartupError(mocap.file, "recording", "packets, or VEHICLE_STATES of an event log",
                             "none");
  }
  notes_.say(fmt::format("{}: {} {}, {:.1f} s", mocap.file, times_.size(),
                         frames_.empty() ? "packets" : "frames",
                         core::toSeconds(times_.back() - times_.front())));
  if (!packets_.damage.empty()) {
    notes_.say(mocap.file + " is damaged: " + packets_.damage + "; what is before is played");
  }
}

ReplaySource::~ReplaySource() = default;

core::Utime ReplaySource::dataTime(core::Utime now) const {
  if (!began_) {
    return times_.front();
  }
  if (speed_ == 0.0) {
    return times_[next_ == 0 ? 0 : next_ - 1];
  }
  const double passed_us = static_cast<double>(now - *began_);
  return times_.front() + static_cast<core::Utime>(speed_ * passed_us);
}

void ReplaySource::play(std::size_t index, PacketSink& sink) {
  if (interpreter_) {
    const StoredPacket& packet = packets_.packets[index];
    if (tap_) {
      tap_(packet.view());
    }
    feed_->feed(packet, *interpreter_, sink);
  } else {
    sink.onFrame(frames_[index]);
  }
}

void ReplaySource::poll(core::Utime now, PacketSink& sink) {
  if (!began_) {
    began_ = now;
  }
  CountingSink counting(sink);
  const core::Utime due = dataTime(now);
  while (!finished() && (speed_ == 0.0 ? counting.frames == 0 : times_[next_] <= due)) {
    play(next_++, counting);
  }
  if (finished() && feed_ && !feed_->remark().empty()) {
    notes_.once("remark", file_ + ": " + feed_->remark());
  }
}

SourceStatus ReplaySource::status() const {
  SourceStatus status;
  status.connected = true;
  status.server = "recording " + file_;
  if (interpreter_) {
    status.bodies = interpreter_->bodies();
    status.counters = interpreter_->counters();
  } else {
    for (const BodyPose& body : frames_.front().bodies) {
      status.bodies.push_back(body.name);
    }
    status.counters.packets = status.counters.frames = static_cast<std::int64_t>(next_);
  }
  return status;
}

}  // namespace roundabout::mocap_bridge
