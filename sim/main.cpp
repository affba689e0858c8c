#include "sim/run_sim.h"

int main(int argc, char** argv) {
  return roundabout::app::run<roundabout::sim::SimOptions>(argc, argv, roundabout::sim::runSim);
}
