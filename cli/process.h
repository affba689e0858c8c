#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace roundabout::cli {

/// What to start and how.
struct ProcessCommand {
  std::string name;                    ///< for reports ("planner hex1")
  std::vector<std::string> arguments;  ///< [0] is the program: a path, or a name looked up in PATH
  std::filesystem::path output_file;   ///< gets stdout and stderr; its folder must exist
  bool ahead_of_others = false;        ///< scheduled in real time where the system allows it
};

/// How a process ended.
struct ExitStatus {
  int code = 0;    ///< valid if signal is 0
  int signal = 0;  ///< that killed it; 0: it ended by itself

  bool clean() const { return code == 0 && signal == 0; }
  /// "exit status 2" or "killed by signal 9 (Killed)".
  std::string describe() const;
};

/// A child process in a process group of its own: a Ctrl-C at the terminal reaches only the parent,
/// which decides. It never outlives its parent, however that ends.
class ChildProcess {
 public:
  /// Throws core::StartupError if the program cannot be started or its output file not be opened.
  explicit ChildProcess(ProcessCommand command);
  /// Kills what still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  const std::string& name() const { return command_.name; }
  pid_t pid() const { return pid_; }
  /// Nothing while it runs. Never waits.
  std::optional<ExitStatus> exited();
  /// Waits for the end; nothing if the time is up before.
  std::optional<ExitStatus> waitFor(std::chrono::milliseconds limit);
  /// Does nothing once it has ended.
  void signal(int number);
  /// SIGNAL, then SIGKILL to its whole group if it has not ended within the limit.
  ExitStatus stop(int number, std::chrono::milliseconds limit);
  /// The end of what it has written, at most this many lines; empty lines are left out.
  std::vector<std::string> lastLines(std::size_t count) const;

 private:
  ProcessCommand command_;
  pid_t pid_ = -1;
  int pid_descriptor_ = -1;
  std::optional<ExitStatus> status_;
};

}  // namespace roundabout::cli
