// Prints the table of docs/perception.md.

#include <numbers>

#include "tests/perception/tracking_run.h"

namespace roundabout::perception {
namespace {

void printTable() {
  const auto row = [](const std::string& what, test::CrowdSettings settings) {
    for (const char* clusterer : {"breakpoints", "dynamic_means"}) {
      settings.field_of_view_rad = 2.0 * std::numbers::pi * (settings.beams - 1) / settings.beams;
      ClearMot all(0.5);
      for (settings.seed = 11; settings.seed <= 13; ++settings.seed) {
        follow(settings, clusterer, 60.0, &all);
      }
      say((what + " " + clusterer).c_str(), all.result());
    }
  };
  row("six people, half of them standing", {});
  row("all walk", {.standing = 0});
  row("robot at 1.2 m/s", {.robot_speed_mps = 1.2});
  row("12 people", {.people = 12, .standing = 4});
  row("18 people, 0.5 m apart", {.people = 18, .standing = 6, .closest_m = 0.5});
  row("within 4 m", {.reach_m = 4.0});
  row("within 8 m", {.reach_m = 8.0, .range_m = 14.0});
  row("5 % missed returns", {.missed_share = 0.05});
  row("20 % missed returns", {.missed_share = 0.2});
  row("40 % missed returns", {.missed_share = 0.4});
  row("range noise 4 cm", {.noise_m = 0.04});
  row("512 beams", {.beams = 512});
  row("360 beams", {.beams = 360});
}

}  // namespace
}  // namespace roundabout::perception

int main() { roundabout::perception::printTable(); }
