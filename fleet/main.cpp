#include "fleet/run_fleet.h"

int main(int argc, char** argv) {
  return roundabout::app::run<roundabout::fleet::FleetOptions>(argc, argv,
                                                               roundabout::fleet::runFleet);
}
