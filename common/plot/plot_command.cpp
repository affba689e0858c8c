#include "common/plot/plot_command.h"

#include <spdlog/fmt/ranges.h>

namespace roundabout::plot {

void PlotCommand::add(const std::vector<std::string>& rows, const std::string& style) {
  if (!rows.empty()) {
    const std::string name = fmt::format("block{}", blocks_++);
    script_.data(name, rows);
    parts_.push_back(fmt::format("${} {}", name, style));
  }
}

void PlotCommand::addKey(const std::string& style, const std::string& text) {
  parts_.push_back(fmt::format("keyentry {} title {}", style, gnuplotString(text)));
}

std::string PlotCommand::text() const {
  return fmt::format("plot {}", fmt::join(parts_, ", \\\n     "));
}

}  // namespace roundabout::plot
