#include "perception/run_perception.h"

int main(int argc, char** argv) {
  return roundabout::app::run<roundabout::perception::PerceptionOptions>(
      argc, argv, roundabout::perception::runPerception);
}
