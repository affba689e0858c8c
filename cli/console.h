#pragma once

#include <string>

namespace roundabout::cli {

/// Lines for the user, above one line that shows progress: rewritten in place on a terminal, else a
/// new line every few seconds.
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
