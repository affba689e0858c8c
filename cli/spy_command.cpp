#include "cli/spy_command.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "cli/console.h"
#include "cli/wall_clock.h"
#include "common/app/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "logs/live/channel_monitor.h"
#include "logs/types/json_text.h"
#include "logs/types/type_table.h"

namespace roundabout::cli {

namespace {

using logs::ChannelState;

struct SpyOptions {
  bool json = false;
  std::string channel;
  std::vector<std::string> types;
  double period_s = 0.5;
  int count = 0;
  std::string lcm_url;
};

std::string typeOf(const ChannelState& state, const logs::TypeTable& types) {
  const logs::MessageType* type = types.find(state.fingerprint);
  return type == nullptr ? fmt::format("{:016x}", state.fingerprint) : type->name;
}

/// The channel's last message as JSON, or why it is none.
std::string fieldsOf(const logs::ChannelMonitor& monitor, const std::string& channel,
                     std::uint64_t fingerprint, const logs::TypeTable& types) {
  const logs::MessageType* type = types.find(fingerprint);
  std::string text;
  if (type == nullptr || logs::appendJson(*type, monitor.last(channel), text) != nullptr) {
    return "null";
  }
  return text;
}

std::string jsonLine(const ChannelState& state, const logs::ChannelMonitor& monitor,
                     const logs::TypeTable& types, bool fields) {
  std::string line =
      fmt::format(R"({{"channel":{},"type":"{}","messages":{},"rate_hz":{:.3f},"jitter_s":{:.6f},)"
                  R"("bytes_per_s":{:.0f},"age_s":{:.3f},"gaps":{})",
                  logs::jsonString(state.channel), typeOf(state, types), state.messages,
                  state.rate_hz, state.jitter_s, state.bytes_per_s, state.age_s, state.gaps);
  if (fields) {
    line += ",\"fields\":" + fieldsOf(monitor, state.channel, state.fingerprint, types);
  }
  return line + "}\n";
}

std::string tableOf(const std::vector<ChannelState>& states, const logs::TypeTable& types) {
  std::string text = fmt::format("{:<28} {:<18} {:>9} {:>9} {:>10} {:>9} {:>8} {:>5}\n", "channel",
                                 "type", "messages", "Hz", "jitter ms", "kB/s", "age s", "gaps");
  for (const ChannelState& state : states) {
    text += fmt::format("{:<28} {:<18} {:>9} {:>9.2f} {:>10.3f} {:>9.1f} {:>8.2f} {:>5}\n",
                        state.channel, typeOf(state, types), state.messages, state.rate_hz,
                        state.jitter_s * 1e3, state.bytes_per_s / 1e3, state.age_s, state.gaps);
  }
  return states.empty() ? text + "nobody is heard\n" : text;
}

std::string report(const SpyOptions& options, const logs::ChannelMonitor& monitor,
                   const logs::TypeTable& types) {
  const std::vector<ChannelState> states = monitor.states(wallTime());
  std::string text = options.json ? "" : tableOf(states, types);
  for (const ChannelState& state : states) {
    const bool chosen = state.channel == options.channel;
    if (options.json && (chosen || options.channel.empty())) {
      text += jsonLine(state, monitor, types, chosen);
    } else if (chosen) {
      const std::string fields = fieldsOf(monitor, state.channel, state.fingerprint, types);
      const auto json = nlohmann::ordered_json::parse(fields, nullptr, false);
      text += "\n" + (json.is_null() ? "of an unknown type, or damaged" : json.dump(2)) + "\n";
    }
  }
  return text;
}

int spy(const SpyOptions& options) {
  standWithoutTerminal();
  const logs::TypeTable types(options.types);
  app::StopSignal stop;
  bus::LcmBus bus(bus::resolveUrl(options.lcm_url));
  logs::ChannelMonitor monitor;
  bus.subscribePrefix("", [&](const bus::Received& received) {
    monitor.see(received.channel, received.payload, received.recv_utime);
  });
  const bool redraw = !options.json && isatty(STDOUT_FILENO) == 1;
  for (int shown = 0; options.count == 0 || shown < options.count; ++shown) {
    for (const double since_s = wallSeconds(); wallSeconds() - since_s < options.period_s;) {
      bus.handle(std::chrono::milliseconds(20));
      if (stop.requested()) {
        return 0;
      }
    }
    const std::string text = (redraw ? "\033[H\033[J" : "") + report(options, monitor, types);
    if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
      return 0;  // nobody reads any more
    }
  }
  return 0;
}

}  // namespace

void addSpyCommand(CLI::App& app, int& exit_status) {
  CLI::App* command =
      app.add_subcommand("spy", "Every channel's rate, jitter, bandwidth, age and gaps, live");
  auto options = std::make_shared<SpyOptions>();
  command->add_option("channel", options->channel, "Also shows this channel's fields");
  command->add_flag("--json", options->json, "One JSON line a channel and period");
  command->add_option("--period", options->period_s, "s")
      ->capture_default_str()
      ->check(CLI::Range(0.05, 3600.0));
  command->add_option("--count", options->count, "Ends after so many periods; 0: never")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--types", options->types, logs::kTypesHelp)
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--lcm-url", options->lcm_url, "Default: LCM_DEFAULT_URL");
  command->callback([options, &exit_status] { exit_status = spy(*options); });
}

}  // namespace roundabout::cli
