#include "perception/watch/run_watch.h"

int main(int argc, char** argv) {
  return roundabout::app::run<roundabout::perception::WatchOptions>(
      argc, argv, roundabout::perception::runWatch);
}
