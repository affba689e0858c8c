#pragma once

#include <optional>
#include <string>

#include <termios.h>

namespace roundabout::cli {

enum class Key { kSpace, kLeft, kRight, kUp, kDown, kStep, kLoop, kBegin, kQuit };

/// Single keys from the terminal, without waiting for a line. Where stdin is no terminal there are
/// none. Gives the terminal back as it was.
class Keys {
 public:
  Keys();
  ~Keys();
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  bool terminal() const { return terminal_; }
  /// A key that was pressed, if there is one; never waits.
  std::optional<Key> next();

 private:
  bool terminal_;
  termios before_{};
  std::string typed_;  // and not yet taken
};

inline constexpr const char* kKeysHelp =
    "space: play, pause · left, right: 5 s · up, down: speed · s: one frame · l: loop · 0: to the "
    "begin · q: quit";

}  // namespace roundabout::cli
