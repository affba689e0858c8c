#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "cli/commands.h"

int main(int argc, char** argv) {
  constexpr int kCannotStart = 2;
  int exit_status = 0;
  CLI::App app("Multi-vehicle experiments in a motion-capture lab", "roundabout");
  app.require_subcommand(1);
  roundabout::cli::addCommands(app, exit_status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    std::fputs(fmt::format("roundabout: {} (try --help)\n", error.what()).c_str(), stderr);
    return kCannotStart;
  } catch (const std::exception& error) {
    std::fputs(fmt::format("roundabout: {}\n", error.what()).c_str(), stderr);
    return kCannotStart;
  }
  return exit_status;
}
