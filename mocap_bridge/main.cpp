#include "mocap_bridge/run_bridge.h"

int main(int argc, char** argv) {
  return roundabout::app::run<roundabout::mocap_bridge::BridgeOptions>(
      argc, argv, roundabout::mocap_bridge::runBridge);
}
