// What the bridge adds between a packet and its message, and how much of a core it takes.

#include <algorithm>
#include <memory>
#include <tuple>

#include <benchmark/benchmark.h>

#include "common/bus/bus.h"
#include "common/bus/lcm_bus.h"
#include "mocap_bridge/bridge_node.h"
#include "mocap_bridge/local_clock.h"
#include "mocap_bridge/sources/sockets.h"
#include "mocap_bridge/sources/table.h"
#include "mocap_bridge/tools/emulate.h"
#include "tests/support/lcm_url.h"

namespace {

using namespace roundabout;

/// Says when the last message went out, and keeps none. With a URL it goes out over LCM.
class StampingBus final : public bus::Bus {
 public:
  StampingBus(const mocap_bridge::LocalClock& clock, const std::string& url) : clock_(clock) {
    if (!url.empty()) {
      wire_ = std::make_unique<bus::LcmBus>(url);
    }
  }
  void publish(const std::string& channel, std::span<const std::byte> payload) override {
    benchmark::DoNotOptimize(payload.data());
    if (wire_) {
      wire_->publish(channel, payload);
    }
    published = clock_.now();
    ++messages;
  }
  void subscribe(const std::string&, Handler) override {}
  void subscribePrefix(const std::string&, Handler) override {}
  int handle(std::chrono::milliseconds) override { return 0; }

  core::Utime published = 0;
  std::int64_t messages = 0;

 private:
  const mocap_bridge::LocalClock& clock_;
  std::unique_ptr<bus::LcmBus> wire_;
};

/// An emulated system and the bridge, in one thread; sockets are real, on loopback.
void packetToMessage(benchmark::State& state, const char* protocol, const std::string& url = "") {
  const int bodies = static_cast<int>(state.range(0));
  mocap_bridge::EmulatorSettings settings;
  std::tie(settings.command_port, settings.data_port) = mocap_bridge::freePorts();
  config::Experiment experiment;
  experiment.mocap.server = "127.0.0.1";
  experiment.mocap.interface = "127.0.0.1";
  experiment.mocap.command_port = settings.command_port;
  experiment.mocap.data_port = settings.data_port;
  for (int i = 0; i < bodies; ++i) {
    experiment.vehicles.emplace_back().name = "hex" + std::to_string(i + 1);
  }
  const mocap_bridge::Protocol& entry = mocap_bridge::protocolNamed(protocol);
  const auto emulator = entry.make_emulator(settings);
  const mocap_bridge::LocalClock clock;
  StampingBus bus(clock, url);
  mocap_bridge::BridgeNode node(experiment, entry.make_session(experiment.mocap),
                                std::string(entry.usual_axes), bus);
  std::vector<double> latencies_us;
  std::int64_t number = 0;
  const core::Utime began = clock.now();
  for (auto _ : state) {
    state.PauseTiming();
    emulator->poll(clock.now());
    // Data time runs at 200 Hz however fast this goes.
    const core::Utime exposure = began + 5'000 * ++number;
    emulator->send(mocap_bridge::circlesAt(exposure, number, bodies), exposure + 4'000);
    const std::int64_t before = bus.messages;
    const core::Utime in = clock.now();
    state.ResumeTiming();
    node.poll(exposure + 4'500);
    if (bus.messages > before) {
      latencies_us.push_back(static_cast<double>(bus.published - in));
    }
  }
  std::sort(latencies_us.begin(), latencies_us.end());
  if (!latencies_us.empty()) {
    state.counters["p50_us"] = latencies_us[latencies_us.size() / 2];
    state.counters["p99_us"] = latencies_us[latencies_us.size() * 99 / 100];
  }
  state.counters["messages"] = static_cast<double>(bus.messages);
  // Share of a core at 200 and 360 frames a second.
  state.counters["frames_per_s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(packetToMessage, natnet, "natnet")->Arg(1)->Arg(20)->Arg(100);
BENCHMARK_CAPTURE(packetToMessage, natnet_and_lcm, "natnet", test::ownLcmUrl())->Arg(20)->Arg(100);
BENCHMARK_CAPTURE(packetToMessage, qualisys, "qualisys")->Arg(20)->Arg(100);
BENCHMARK_CAPTURE(packetToMessage, vicon_udp, "vicon_udp")->Arg(20)->Arg(100);

}  // namespace
