#include "logs/export/cut.h"

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "logs/files.h"

namespace roundabout::logs {

namespace {

void put(std::string& bytes, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) {
    bytes += static_cast<char>(value >> (8 * i));
  }
}

std::string headerOf(const Event& event, std::size_t number) {
  std::string bytes;
  put(bytes, kSyncWord, 4);
  put(bytes, number, 8);
  put(bytes, static_cast<std::uint64_t>(event.log_utime), 8);
  put(bytes, event.channel.size(), 4);
  put(bytes, event.payload.size(), 4);
  return bytes;
}

void refuseToReplace(const EventLog& log, const std::string& file) {
  const std::vector<std::string> files = log.files();
  const bool same = std::any_of(files.begin(), files.end(), [&](const std::string& part) {
    std::error_code error;
    return std::filesystem::equivalent(part, file, error);
  });
  if (same) {
    throw core::StartupError(file, "output", "another file than the log", "the log");
  }
}

}  // namespace

std::size_t cutLog(const EventLog& log, const CutOptions& options, const std::string& file) {
  refuseToReplace(log, file);
  ChannelFilter filter(options.only, options.except);
  FileWriter out(file);
  const core::Utime begin = log.logUtime(0);
  std::size_t count = 0;
  for (std::size_t i = log.indexAt(begin + core::toUtime(options.from_s)); i < log.size(); ++i) {
    if (core::toSeconds(log.logUtime(i) - begin) > options.to_s) {
      continue;
    }
    const Event event = log[i];
    if (filter.passes(event.channel)) {
      out.write(headerOf(event, count++));
      out.write(event.channel);
      out.write({reinterpret_cast<const char*>(event.payload.data()), event.payload.size()});
    }
  }
  out.finish();
  return count;
}

}  // namespace roundabout::logs
