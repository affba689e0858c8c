#include "cli/process.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <spdlog/fmt/fmt.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

extern "C" {  // which glibc 2.36 forgot
#include <sys/pidfd.h>
}

#include "cli/file_tail.h"
#include "common/core/error.h"

namespace roundabout::cli {

namespace {

constexpr std::size_t kTailBytes = 8192;

// Between fork and exec of a process with threads only what is async-signal-safe may be called.
[[noreturn]] void becomeChild(char* const* arguments, int output, int failure, pid_t parent,
                              bool ahead_of_others) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) {
    _exit(EXIT_FAILURE);
  }
  if (ahead_of_others) {
    sched_param priority{};
    priority.sched_priority = 1;
    sched_setscheduler(0, SCHED_RR, &priority);  // refused without the right to: then as everybody
  }
  const int input = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execvp(arguments[0], arguments);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(failure, &error, sizeof(error));
  _exit(EXIT_FAILURE);
}

ExitStatus fromWait(int status) {
  return WIFSIGNALED(status) ? ExitStatus{0, WTERMSIG(status)} : ExitStatus{WEXITSTATUS(status), 0};
}

}  // namespace

std::string ExitStatus::describe() const {
  return signal == 0 ? fmt::format("exit status {}", code)
                     : fmt::format("killed by signal {} ({})", signal, strsignal(signal));
}

ChildProcess::ChildProcess(ProcessCommand command) : command_(std::move(command)) {
  const int output =
      open(command_.output_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (output < 0) {
    throw core::StartupError(command_.output_file.string(), command_.name, "a file to write to",
                             std::strerror(errno));
  }
  std::vector<char*> arguments;
  for (std::string& argument : command_.arguments) {
    arguments.push_back(argument.data());
  }
  arguments.push_back(nullptr);

  int failure[2] = {-1, -1};
  const pid_t parent = getpid();
  pid_ = pipe2(failure, O_CLOEXEC) == 0 ? fork() : -1;
  if (pid_ == 0) {
    becomeChild(arguments.data(), output, failure[1], parent, command_.ahead_of_others);
  }
  int error = pid_ < 0 ? errno : 0;
  close(output);
  close(failure[1]);
  if (pid_ > 0 && read(failure[0], &error, sizeof(error)) == sizeof(error)) {
    waitpid(pid_, nullptr, 0);
  }
  close(failure[0]);
  if (error != 0) {
    throw core::StartupError(command_.arguments[0], command_.name, "a program that can be started",
                             std::strerror(error));
  }
  pid_descriptor_ = pidfd_open(pid_, 0);
}

ChildProcess::~ChildProcess() {
  if (!status_) {
    stop(SIGKILL, std::chrono::milliseconds(0));
  }
  if (pid_descriptor_ >= 0) {
    close(pid_descriptor_);
  }
}

std::optional<ExitStatus> ChildProcess::exited() {
  int status = 0;
  if (!status_ && waitpid(pid_, &status, WNOHANG) == pid_) {
    status_ = fromWait(status);
  }
  return status_;
}

std::optional<ExitStatus> ChildProcess::waitFor(std::chrono::milliseconds limit) {
  if (!exited()) {
    pollfd ended{pid_descriptor_, POLLIN, 0};
    poll(&ended, 1, static_cast<int>(limit.count()));
  }
  return exited();
}

void ChildProcess::signal(int number) {
  if (!exited()) {
    kill(pid_, number);
  }
}

ExitStatus ChildProcess::stop(int number, std::chrono::milliseconds limit) {
  signal(number);
  if (const auto status = waitFor(limit)) {
    return *status;
  }
  kill(-pid_, SIGKILL);
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  status_ = fromWait(status);
  return *status_;
}

std::vector<std::string> ChildProcess::lastLines(std::size_t count) const {
  std::istringstream text(fileTail(command_.output_file, kTailBytes));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    if (!line.empty()) {
      lines.push_back(line);
    }
  }
  if (lines.size() > count) {
    lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(count));
  }
  return lines;
}

}  // namespace roundabout::cli
