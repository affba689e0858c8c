#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "logs/files.h"

namespace roundabout::logs {

/// Writes comma-separated values (RFC 4180, but lines end as on Unix), whole or not at all.
class CsvTable {
 public:
  CsvTable(const std::string& file, const std::vector<std::string>& header) : out_(file) {
    for (const std::string& name : header) {
      text(name);
    }
    endRow();
  }

  void text(std::string_view value);
  void integer(std::int64_t value);
  /// As many digits as tell it from its neighbours; nothing if it is not finite.
  void real(double value);
  void real(float value);
  void fixed(double value, int decimals);
  void blank() { separate(); }
  void endRow();

  std::size_t rows() const { return rows_; }
  /// Throws core::StartupError if it cannot be written.
  void finish() { out_.finish(); }

 private:
  void separate();

  FileWriter out_;
  std::string line_;
  bool first_ = true;
  std::size_t rows_ = 0;
};

}  // namespace roundabout::logs
