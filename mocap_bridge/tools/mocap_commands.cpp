#include "mocap_bridge/tools/mocap_commands.h"

#include <memory>

#include "common/config/keys.h"
#include "mocap_bridge/tools/decode.h"
#include "mocap_bridge/tools/emulate.h"
#include "mocap_bridge/tools/listen.h"

namespace roundabout::mocap_bridge {

namespace {

CLI::Validator protocolName() {
  return CLI::IsMember(std::vector<std::string>(config::kMocapProtocols));
}

void addDecode(CLI::App& mocap, int& exit_status) {
  auto options = std::make_shared<DecodeOptions>();
  CLI::App* command = mocap.add_subcommand("decode",
                                           "Print recorded packets as JSON lines: positions in "
                                           "metres and quaternions in the order x, y, "
                                           "z, w, both in the system's own axes");
  command->add_option("--protocol", options->protocol, "Of the packets")
      ->check(protocolName())
      ->capture_default_str();
  command->add_option("--version", options->version,
                      "natnet: of the packets, as 2.7, unless a server info among them says it");
  command
      ->add_option("files", options->files,
                   "Each one packet (or stream), our records, or a pcapng capture")
      ->required();
  command->callback([options, &exit_status] { exit_status = decode(*options); });
}

void addListener(CLI::App& mocap, int& exit_status, const char* name, const char* description,
                 int (*run)(const ListenOptions&), bool writes) {
  auto options = std::make_shared<ListenOptions>();
  CLI::App* command = mocap.add_subcommand(name, description);
  command->add_option("file", options->experiment_file, "Experiment file with source and mocap")
      ->required();
  if (writes) {
    command->add_option("-o,--out", options->out, "File for the packets")->required();
  }
  command->add_option("--seconds", options->seconds, "Ends by itself after this long");
  command->add_option("--set", options->overrides, "Overrides a key of the experiment; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
  command->callback([options, run, &exit_status] { exit_status = run(*options); });
}

void addEmulate(CLI::App& mocap, int& exit_status) {
  auto options = std::make_shared<EmulateOptions>();
  CLI::App* command =
      mocap.add_subcommand("emulate", "Serve a simulated scene as a motion-capture system would");
  command->add_option("protocol", options->protocol, "What to speak")
      ->required()
      ->check(protocolName());
  EmulatorSettings& settings = options->settings;
  command->add_option("--bodies", options->bodies, "hex1, hex2 … on circles")
      ->capture_default_str();
  command->add_option("--rate", settings.rate_hz, "Hz, of the cameras")->capture_default_str();
  command->add_option("--version", settings.version, "natnet: 2.5 to 4.2");
  command->add_option("--transport", settings.transport, "natnet")
      ->check(CLI::IsMember({"multicast", "unicast"}))
      ->capture_default_str();
  command->add_option("--address", settings.address, "Of the interface to serve on")
      ->capture_default_str();
  command->add_option("--command-port", settings.command_port, "Instead of the protocol's");
  command->add_option("--data-port", settings.data_port, "Instead of the protocol's");
  command->add_option("--group", settings.group, "Instead of the protocol's multicast group");
  command->add_option("--to", settings.to, "vicon_udp: who gets the datagrams")
      ->capture_default_str();
  command
      ->add_option("--scene", options->scene,
                   "circles, or sim: what `sim --scene` simulates on this LCM URL")
      ->check(CLI::IsMember({"circles", "sim"}))
      ->capture_default_str();
  command->add_option("--lcm-url", options->lcm_url, "Where `sim --scene` publishes");
  command->add_option("--seconds", options->seconds, "Ends by itself after this long");
  command->callback([options, &exit_status] { exit_status = emulate(*options); });
}

}  // namespace

void addMocapCommands(CLI::App& app, int& exit_status) {
  CLI::App* mocap = app.add_subcommand("mocap", "Look at, record and emulate motion capture");
  mocap->require_subcommand(1);
  addDecode(*mocap, exit_status);
  addListener(*mocap, exit_status, "watch",
              "Show every body live: rate, age, residual, gaps, latency, and which vehicle it is",
              watch, false);
  addListener(*mocap, exit_status, "record", "Write packets to a file that source: replay plays",
              record, true);
  addEmulate(*mocap, exit_status);
}

}  // namespace roundabout::mocap_bridge
