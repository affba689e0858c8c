#include "cli/perception_command.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::cli {

namespace {

/// Becomes perception_watch: this program does not link OpenCV.
void watch(const std::vector<std::string>& more) {
  const std::string program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "perception_watch").string();
  std::vector<std::string> words{program};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  throw core::StartupError(program, "perception watch", "a program", std::strerror(errno));
}

}  // namespace

void addPerceptionCommand(CLI::App& app) {
  CLI::App* perception = app.add_subcommand("perception", "What vehicles see");
  perception->require_subcommand(1);
  CLI::App* command = perception->add_subcommand(
      "watch", "Show from above what a vehicle sees, or record it as a video");
  command->prefix_command();
  command->set_help_flag();  // the program's own
  command->footer(
      "--config FILE --vehicle NAME [--record FILE.avi] [--picture FILE.png] "
      "[--seconds S] [--no-window] [--lcm-url URL]");
  command->callback([command] { watch(command->remaining()); });
}

}  // namespace roundabout::cli
