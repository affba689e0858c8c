#pragma once

#include <string>

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// The metrics as JSON, laid out as in docs/logs.md: keys end in their unit; null for what does
/// not exist.
std::string toJson(const Metrics& metrics);

/// Throws core::StartupError if the file cannot be written.
void writeMetricsJson(const Metrics& metrics, const std::string& file);

}  // namespace roundabout::logs
