#include "mocap_bridge/tools/listen.h"

#include <cstdio>
#include <functional>
#include <optional>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "common/app/stop_signal.h"
#include "common/config/experiment_file.h"
#include "mocap_bridge/local_clock.h"
#include "mocap_bridge/make_source.h"
#include "mocap_bridge/sources/replay/packet_file.h"
#include "mocap_bridge/tools/body_table.h"

namespace roundabout::mocap_bridge {

namespace {

struct FrameSink final : PacketSink {
  void onFrame(const SourceFrame& frame) override {
    ++frames;
    if (take) {
      take(frame);
    }
  }
  std::function<void(const SourceFrame&)> take;
  std::int64_t frames = 0;
};

/// Polls a source until it is stopped, the time is up or a recording has ended; calls `often` a few
/// hundred times a second.
void listenTo(Source& source, FrameSink& sink, double seconds,
              const std::function<bool(core::Utime)>& often) {
  app::StopSignal stop;
  const LocalClock clock;
  const core::Utime began = clock.now();
  source.setArrivalClock([&clock] { return clock.now(); });
  std::vector<pollfd> descriptors;
  while (!stop.requested() && !source.finished() &&
         (seconds <= 0.0 || clock.now() - began < core::toUtime(seconds))) {
    source.poll(clock.now(), sink);
    for (const std::string& note : source.takeNotes()) {
      std::fprintf(stderr, "%s\n", note.c_str());
    }
    if (!often(source.dataTime(clock.now()))) {
      break;
    }
    descriptors = {{stop.fileDescriptor(), POLLIN, 0}};
    source.addDescriptors(descriptors);
    ::poll(descriptors.data(), descriptors.size(), 5);
  }
  source.setArrivalClock(nullptr);
}

}  // namespace

int watch(const ListenOptions& options) {
  const config::Experiment experiment =
      config::readExperiment(options.experiment_file, options.overrides);
  const std::unique_ptr<Source> source = makeSource(experiment);
  StateEstimator estimator(experiment, usualAxes(experiment));
  BodyTable table;
  FrameSink sink;
  sink.take = [&](const SourceFrame& frame) {
    estimator.update(frame);
    table.add(frame);
  };
  constexpr core::Utime kRefresh = core::kMicrosPerSecond;
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  core::Utime last_text = 0;
  const auto show = [&](core::Utime now) {
    if (sink.frames > 0) {
      fmt::print("{}{}\n{}", terminal ? "\x1b[H\x1b[2J" : "", source->status().server,
                 table.text(now, estimator));
      std::fflush(stdout);
    }
    last_text = now;
  };
  listenTo(*source, sink, options.seconds, [&](core::Utime now) {
    if (last_text == 0) {
      table.begin(now);
      last_text = now;
    } else if (now - last_text >= kRefresh) {
      show(now);
    }
    return true;
  });
  if (sink.frames == 0) {
    std::fprintf(stderr, "no frame came\n");
    return 1;
  }
  const SourceCounters counters = source->status().counters;
  fmt::print(
      "{} packets, {} frames, {} lost, {} doubled or late, {} broken, {} of other machines\n",
      counters.packets, counters.frames, counters.lost_frames, counters.old_frames,
      counters.malformed, counters.wrong_sender);
  return 0;
}

int record(const ListenOptions& options) {
  const config::Experiment experiment =
      config::readExperiment(options.experiment_file, options.overrides);
  const std::unique_ptr<Source> source = makeSource(experiment);
  PacketWriter writer(options.out);
  std::int64_t packets = 0;
  bool written = true;
  source->setTap([&](const Packet& packet) {
    written = writer.write(packet) && written;
    packets += packet.payload.empty() ? 0 : 1;
  });
  FrameSink sink;
  listenTo(*source, sink, options.seconds, [&](core::Utime) { return written; });
  if (!written) {
    std::fprintf(stderr, "%s: could not be written: is the disk full?\n", options.out.c_str());
    return 1;
  }
  fmt::print("{} packets, {} frames in {}\n", packets, sink.frames, options.out);
  if (sink.frames == 0) {
    std::fprintf(stderr, "no frame came\n");
    return 1;
  }
  return 0;
}

}  // namespace roundabout::mocap_bridge
