#include "mocap_bridge/tools/emulate.h"

#include <cmath>
#include <numbers>

#include <spdlog/fmt/fmt.h>

#include "common/app/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "mocap_bridge/estimation/axes.h"
#include "mocap_bridge/local_clock.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

namespace {

// Exposure to sending, as of cameras at 200 Hz.
constexpr core::Utime kCameraLatency = 4'000;

class Server {
 public:
  explicit Server(const EmulateOptions& options)
      : options_(options),
        protocol_(protocolNamed(options.protocol)),
        axes_(AxisMap(std::string(protocol_.usual_axes)).inverse()),
        emulator_(protocol_.make_emulator(options.settings)) {}

  int run() {
    fmt::print("{} on {}, port {}\n", options_.protocol, options_.settings.address,
               emulator_->commandPort());
    std::fflush(stdout);
    options_.scene == "sim" ? serveSimulation() : serveCircles();
    return 0;
  }

 private:
  bool over() {
    const bool time_is_up =
        options_.seconds > 0.0 && clock_.now() - began_ > core::toUtime(options_.seconds);
    return time_is_up || stop_.requested();
  }

  void wait(core::Utime deadline, int bus_descriptor) {
    std::vector<pollfd> descriptors{{stop_.fileDescriptor(), POLLIN, 0}};
    emulator_->addDescriptors(descriptors);
    if (bus_descriptor >= 0) {
      descriptors.push_back({bus_descriptor, POLLIN, 0});
    }
    const core::Utime left = std::max<core::Utime>(deadline - clock_.now(), 0);
    const timespec time{left / core::kMicrosPerSecond, left % core::kMicrosPerSecond * 1000};
    ppoll(descriptors.data(), descriptors.size(), &time, nullptr);
  }

  void send(SourceFrame& frame) {
    for (BodyPose& body : frame.bodies) {
      body.position_m = axes_.toWorld(body.position_m);
      body.orientation = axes_.toWorld(body.orientation);
    }
    emulator_->send(frame, clock_.now());
  }

  void serveCircles() {
    const core::Utime interval = core::toUtime(1.0 / options_.settings.rate_hz);
    core::Utime next = clock_.now();
    for (std::int64_t number = 0; !over();) {
      emulator_->poll(clock_.now());
      if (clock_.now() >= next) {
        SourceFrame frame = circlesAt(next - kCameraLatency, number++, options_.bodies);
        send(frame);
        next += interval;
      }
      wait(next, -1);
    }
  }

  void serveSimulation() {
    bus::LcmBus bus(bus::resolveUrl(options_.lcm_url));
    core::StatesFrame states;
    bus::subscribe<roundabout_msgs::vehicle_states_t>(
        bus, bus::kSceneChannel,
        [&](const roundabout_msgs::vehicle_states_t& message) {
          bus::fromMessage(message, states);
          SourceFrame frame;
          frame.number = states.frame_number;
          frame.exposure_utime = states.utime;
          for (std::size_t i = 0; i < states.vehicles.size(); ++i) {
            const core::VehicleState& state = states.vehicles[i];
            frame.bodies.push_back({state.name, static_cast<std::int64_t>(i + 1),
                                    state.position_world_m, state.orientation, state.tracked,
                                    0.0005});
          }
          send(frame);
        },
        [](const bus::DecodeError&) {});
    while (!over()) {
      emulator_->poll(clock_.now());
      bus.handle(std::chrono::milliseconds(0));
      wait(clock_.now() + 20'000, bus.fileDescriptor());
    }
  }

  const EmulateOptions& options_;
  const Protocol& protocol_;
  AxisMap axes_;
  app::StopSignal stop_;
  std::unique_ptr<Emulator> emulator_;
  LocalClock clock_;
  core::Utime began_ = clock_.now();
};

}  // namespace

SourceFrame circlesAt(core::Utime utime, std::int64_t number, int bodies) {
  constexpr double kFirstRadius_m = 1.0;
  constexpr double kSpacing_m = 1.0;
  constexpr double kSpeed_mps = 1.0;
  SourceFrame frame;
  frame.number = number;
  frame.exposure_utime = utime;
  // Modulo a day: sines of 1e9 seconds are not smooth.
  const double time_s = core::toSeconds(utime % (86'400 * core::kMicrosPerSecond));
  for (int i = 0; i < bodies; ++i) {
    const double radius_m = kFirstRadius_m + kSpacing_m * i;
    const double angle = kSpeed_mps / radius_m * time_s;
    BodyPose& body = frame.bodies.emplace_back();
    body.name = fmt::format("hex{}", i + 1);
    body.id = i + 1;
    body.position_m = {radius_m * std::cos(angle), radius_m * std::sin(angle), 1.0};
    body.orientation = Eigen::AngleAxisd(angle + 0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ());
    body.tracked = true;
    body.residual_m = 0.0005;
  }
  return frame;
}

int emulate(const EmulateOptions& options) { return Server(options).run(); }

}  // namespace roundabout::mocap_bridge
