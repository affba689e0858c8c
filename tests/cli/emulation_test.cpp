#include "cli/emulation.h"

#include <gtest/gtest.h>

#include "common/config/experiment_file.h"

namespace roundabout::cli {
namespace {

TEST(Emulation, NothingThatALabsFileSaysOfItsOwnSystemIsLeft) {
  const std::string lab = R"(
vehicles: [{name: hex1}]
source: natnet
mocap:
  server: 10.0.0.7
  interface: 127.0.0.1
  command_port: 2510
  data_port: 2511
  group: 239.1.2.3
  transport: unicast
  axes: z_up
  rotation: zyx
  scale: 0.001
  rate_hz: 120
  latency_s: 0.02
  filter: {coast_s: 0.2}
  bodies: [{vehicle: hex1, id: 4}]
)";
  config::Experiment experiment =
      config::parseExperiment(lab, "lab.yaml", emulationOverrides("vicon_udp"));
  EXPECT_EQ(experiment.source, "vicon_udp");
  EXPECT_EQ(experiment.mocap.server, "127.0.0.1");
  EXPECT_NE(experiment.mocap.command_port, 2510);
  EXPECT_NE(experiment.mocap.data_port, 2511);
  config::Experiment usual;
  usual.vehicles = experiment.vehicles;
  usual.source = experiment.source;
  usual.mocap.server = experiment.mocap.server;
  usual.mocap.interface = experiment.mocap.interface;
  usual.mocap.command_port = experiment.mocap.command_port;
  usual.mocap.data_port = experiment.mocap.data_port;
  usual.mocap.filter.coast_s = 0.2;
  experiment.name = usual.name;
  EXPECT_EQ(toYaml(experiment), toYaml(usual));
}

}  // namespace
}  // namespace roundabout::cli
