#include "cli/replay/keys.h"

#include <algorithm>
#include <string_view>

#include <poll.h>
#include <unistd.h>

namespace roundabout::cli {

namespace {

/// The key that the bytes begin with, and takes it off them; of anything else one byte.
std::optional<Key> takeKey(std::string& bytes) {
  constexpr std::pair<std::string_view, Key> kKeys[] = {
      {" ", Key::kSpace},     {"\033[D", Key::kLeft}, {"\033[C", Key::kRight}, {"\033[A", Key::kUp},
      {"\033[B", Key::kDown}, {"s", Key::kStep},      {".", Key::kStep},       {"l", Key::kLoop},
      {"0", Key::kBegin},     {"q", Key::kQuit}};
  for (const auto& [text, key] : kKeys) {
    if (bytes.starts_with(text)) {
      bytes.erase(0, text.size());
      return key;
    }
  }
  bytes.erase(0, 1);
  return std::nullopt;
}

}  // namespace

Keys::Keys() : terminal_(isatty(STDIN_FILENO) == 1 && tcgetattr(STDIN_FILENO, &before_) == 0) {
  // In the background, changing the terminal would stop the program.
  terminal_ = terminal_ && tcgetpgrp(STDIN_FILENO) == getpgrp();
  if (terminal_) {
    termios single = before_;
    single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    single.c_cc[VMIN] = 0;
    single.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &single);
  }
}

Keys::~Keys() {
  if (terminal_) {
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
}

std::optional<Key> Keys::next() {
  pollfd poll_in{STDIN_FILENO, POLLIN, 0};
  if (terminal_ && poll(&poll_in, 1, 0) > 0) {
    char bytes[64];
    const ssize_t size = read(STDIN_FILENO, bytes, sizeof(bytes));
    typed_.append(bytes, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  }
  std::optional<Key> key;
  // An arrow's bytes may come one by one.
  while (!key && !typed_.empty() && typed_ != "\033" && typed_ != "\033[") {
    key = takeKey(typed_);
  }
  return key;
}

}  // namespace roundabout::cli
