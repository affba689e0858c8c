#pragma once

#include <string>

namespace roundabout::cli {

/// For a program that must outlive its terminal: writing to a pipe that nobody reads any more is no
/// reason to end, and standard streams that are closed become /dev/null, lest another file take
/// their place.
void standWithoutTerminal();

/// Lines for the user, above one line that shows progress: rewritten in place on a terminal, else a
/// new line every few seconds. What cannot be written is lost.
class Console {
 public:
  Console();
  /// Ends the progress line, if there is one.
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void say(const std::string& line);
  /// Cheap to call often.
  void progress(const std::string& line);
  /// True if a call to progress() would show something now.
  bool progressDue() const;

 private:
  void clear();

  bool terminal_;
  bool live_line_ = false;
  double last_progress_s_;
};

}  // namespace roundabout::cli
