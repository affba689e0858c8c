// Needs a log: ROUNDABOUT_LONG_LOG, as make_long_log writes it. Without it there is nothing to
// measure.

#include <cstdlib>
#include <string>

#include <benchmark/benchmark.h>

#include "common/core/random.h"
#include "logs/metrics/metrics.h"
#include "logs/reading/event_index.h"
#include "logs/reading/event_log.h"

namespace roundabout::logs {
namespace {

constexpr std::size_t kNever = static_cast<std::size_t>(-1);

std::string logFile(benchmark::State& state) {
  const char* file = std::getenv("ROUNDABOUT_LONG_LOG");
  if (file == nullptr) {
    state.SkipWithError("set ROUNDABOUT_LONG_LOG to a log of make_long_log");
    return "";
  }
  return file;
}

void logIndex(benchmark::State& state) {
  const std::string file = logFile(state);
  for (auto _ : state) {
    if (!file.empty()) {
      const EventLog log(file, kNever);
      state.counters["events"] = static_cast<double>(log.size());
      state.counters["bytes"] = static_cast<double>(log.fileBytes());
    }
  }
}
BENCHMARK(logIndex)->Unit(benchmark::kMillisecond);

// Opens the log by its index and reads what is at a random time.
void logSeek(benchmark::State& state) {
  const std::string file = logFile(state);
  core::RandomStream random(1, "seek");
  if (!file.empty()) {
    const EventLog first(file);
  }
  for (auto _ : state) {
    if (!file.empty()) {
      const EventLog log(file);
      const double span = static_cast<double>(log.logUtime(log.size() - 1) - log.logUtime(0));
      const auto at =
          log.indexAt(log.logUtime(0) + static_cast<core::Utime>(random.uniform(0.0, span)));
      benchmark::DoNotOptimize(log[at].payload.data()[0]);
    }
  }
}
BENCHMARK(logSeek)->Unit(benchmark::kMillisecond);

void logMetrics(benchmark::State& state) {
  const std::string file = logFile(state);
  for (auto _ : state) {
    if (!file.empty()) {
      benchmark::DoNotOptimize(computeMetrics(readFlight(file)));
    }
  }
}
BENCHMARK(logMetrics)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace roundabout::logs
