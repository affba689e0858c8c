#include "logs/export/csv_table.h"

#include <cmath>
#include <iterator>

#include <spdlog/fmt/fmt.h>

namespace roundabout::logs {

void CsvTable::separate() {
  if (!first_) {
    line_ += ',';
  }
  first_ = false;
}

void CsvTable::text(std::string_view value) {
  separate();
  if (value.find_first_of(",\"\r\n") == std::string_view::npos) {
    line_ += value;
    return;
  }
  line_ += '"';
  for (const char c : value) {
    line_.append(c == '"' ? 2 : 1, c);
  }
  line_ += '"';
}

void CsvTable::integer(std::int64_t value) {
  separate();
  fmt::format_to(std::back_inserter(line_), "{}", value);
}

void CsvTable::real(double value) {
  separate();
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(line_), "{}", value);
  }
}

void CsvTable::real(float value) {
  separate();
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(line_), "{}", value);
  }
}

void CsvTable::fixed(double value, int decimals) {
  separate();
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(line_), "{:.{}f}", value, decimals);
  }
}

void CsvTable::endRow() {
  line_ += '\n';
  out_.write(line_);
  line_.clear();
  first_ = true;
  ++rows_;
}

}  // namespace roundabout::logs
