#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

namespace roundabout::plot {

/// A gnuplot script that is built line by line and run by one gnuplot process.
class GnuplotScript {
 public:
  /// Adds a line, formatted as fmt does.
  template <class... Arguments>
  void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    text_ += fmt::format(format, std::forward<Arguments>(arguments)...);
    text_ += '\n';
  }

  /// Adds an inline data block, to be plotted as $name. One row a line; an empty row breaks a
  /// curve.
  void data(std::string_view name, const std::vector<std::string>& rows);

  /// Runs the script. Throws core::StartupError if gnuplot is missing (naming the Debian package)
  /// or reports an error (quoting it).
  void run() const;

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A gnuplot string literal with this text, whatever it holds.
std::string gnuplotString(std::string_view text);

}  // namespace roundabout::plot
