#pragma once

#include <string>
#include <vector>

#include "common/plot/gnuplot_script.h"

namespace roundabout::plot {

/// Collects the parts of one plot command of a script.
class PlotCommand {
 public:
  explicit PlotCommand(GnuplotScript& script) : script_(script) {}

  /// Adds a data block and how it is drawn; nothing if there are no rows.
  void add(const std::vector<std::string>& rows, const std::string& style);
  /// An entry of the key alone.
  void addKey(const std::string& style, const std::string& text);

  std::string text() const;

 private:
  GnuplotScript& script_;
  std::vector<std::string> parts_;
  int blocks_ = 0;
};

}  // namespace roundabout::plot
