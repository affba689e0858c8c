#include "common/plot/gnuplot_script.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::plot {

namespace {

constexpr const char* kProgram = "gnuplot";

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

TemporaryFile makeTemporaryFile() {
  TemporaryFile file(std::tmpfile());
  if (!file) {
    throw core::StartupError(kProgram, "temporary file", "a place to write", std::strerror(errno));
  }
  return file;
}

std::string contentOf(std::FILE* file) {
  std::rewind(file);
  std::array<char, 4096> buffer;
  std::string content;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file)) {
    content.append(buffer.data(), count);
  }
  return content;
}

/// The line of gnuplot's complaint that says what is wrong; it comes after the offending line.
std::string complaint(const std::string& output) {
  std::size_t end = output.find_last_not_of(" \n");
  if (end == std::string::npos) {
    return "no message";
  }
  const std::size_t begin = output.rfind('\n', end);
  return output.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

}  // namespace

void GnuplotScript::data(std::string_view name, const std::vector<std::string>& rows) {
  line("${} << EOD", name);
  for (const std::string& row : rows) {
    line("{}", row);
  }
  line("EOD");
}

void GnuplotScript::run() const {
  // Files instead of pipes: neither side can block the other or die of SIGPIPE.
  const TemporaryFile input = makeTemporaryFile();
  const TemporaryFile output = makeTemporaryFile();
  std::fwrite(text_.data(), 1, text_.size(), input.get());
  std::fflush(input.get());
  lseek(fileno(input.get()), 0, SEEK_SET);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(output.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(output.get()), STDERR_FILENO);
  std::string argument = kProgram;
  std::array<char*, 2> arguments{argument.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, kProgram, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw core::StartupError(kProgram, "program",
                             "to be installed (Debian package gnuplot-nox) for figures",
                             std::strerror(error));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw core::StartupError(kProgram, "figures", "a script that runs",
                             complaint(contentOf(output.get())));
  }
}

std::string gnuplotString(std::string_view text) {
  std::string result = "\"";
  for (const char character : text) {
    if (character == '"' || character == '\\' || character == '`') {  // ` runs a command
      result += '\\';
    }
    result += static_cast<unsigned char>(character) < ' ' ? ' ' : character;
  }
  return result + '"';
}

}  // namespace roundabout::plot
