#include "tests/logs/log_writer.h"

#include <vector>

namespace roundabout::logs {

void LogWriter::writeBytes(core::Utime log_utime, const std::string& channel,
                           std::span<const std::byte> payload) {
  std::string name = channel;
  std::vector<std::byte> bytes(payload.begin(), payload.end());
  lcm_eventlog_event_t event{};
  event.timestamp = log_utime;
  event.channellen = static_cast<std::int32_t>(name.size());
  event.channel = name.data();
  event.datalen = static_cast<std::int32_t>(bytes.size());
  event.data = bytes.data();
  lcm_eventlog_write_event(log_, &event);
}

}  // namespace roundabout::logs
