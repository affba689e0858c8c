#include "planner/run_planner.h"

int main(int argc, char** argv) {
  return roundabout::app::run<roundabout::planner::PlannerOptions>(argc, argv,
                                                                   roundabout::planner::runPlanner);
}
