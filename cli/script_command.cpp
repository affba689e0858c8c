#include "cli/script_command.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::cli {

namespace {

struct ScriptOptions {
  std::string file;
  std::vector<std::string> arguments;
  std::string lcm_url;
};

void prepend(const char* variable, const std::string& value, const std::string& separator,
             const std::string& otherwise) {
  const char* before = std::getenv(variable);
  const std::string after = before != nullptr ? before : otherwise;
  setenv(variable, (after.empty() ? value : value + separator + after).c_str(), 1);
}

[[noreturn]] void become(const std::vector<std::string>& words, const char* package) {
  std::vector<char*> arguments;
  for (const std::string& word : words) {
    arguments.push_back(const_cast<char*>(word.c_str()));  // execvp() leaves them as they are
  }
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  throw core::StartupError(words[0], "script", std::string("the Debian package ") + package,
                           std::strerror(errno));
}

void runScript(const ScriptOptions& options) {
  const std::filesystem::path programs =
      std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::filesystem::path modules = programs.parent_path() / "scripting";
  const std::string ending = std::filesystem::path(options.file).extension();
  if (access(options.file.c_str(), R_OK) != 0) {
    throw core::StartupError(options.file, "script", "a file that can be read",
                             std::strerror(errno));
  }
  if (!options.lcm_url.empty()) {
    setenv("LCM_DEFAULT_URL", options.lcm_url.c_str(), 1);
  }
  std::vector<std::string> words{options.file};
  words.insert(words.end(), options.arguments.begin(), options.arguments.end());
  if (ending == ".py") {
    prepend("PYTHONPATH", (modules / "python").string(), ":", "");
    words.insert(words.begin(), "python3");
    become(words, "python3");
  }
  if (ending == ".lua") {
    const std::string folder = (modules / "lua").string();
    // Two semicolons stand for Lua's own path.
    prepend("LUA_PATH", folder + "/?.lua;" + folder + "/?/init.lua", ";", ";");
    words.insert(words.begin(), "lua5.2");
    become(words, "lua5.2 (and liblcm-lua)");
  }
  throw core::StartupError(options.file, "script", "a file that ends in .py or .lua", ending);
}

}  // namespace

void addScriptCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("script", "Run a Python or Lua script that flies the fleet");
  auto options = std::make_shared<ScriptOptions>();
  command->add_option("file", options->file, "SCRIPT.py or SCRIPT.lua")->required();
  command->add_option("arguments", options->arguments, "For the script");
  command->add_option("--lcm-url", options->lcm_url, "Default: LCM_DEFAULT_URL");
  command->callback([options] { runScript(*options); });
}

}  // namespace roundabout::cli
