#pragma once

// Writes the logs that tests read: with liblcm's own writer, so that the reader is held against the
// format and not against itself.

#include <string>

#include <lcm/eventlog.h>

#include "common/bus/typed.h"
#include "common/core/time.h"

namespace roundabout::logs {

class LogWriter {
 public:
  explicit LogWriter(const std::string& file) : log_(lcm_eventlog_create(file.c_str(), "w")) {}
  ~LogWriter() { lcm_eventlog_destroy(log_); }
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  void writeBytes(core::Utime log_utime, const std::string& channel,
                  std::span<const std::byte> payload);

  template <class Message>
  void write(core::Utime log_utime, const std::string& channel, const Message& message) {
    writeBytes(log_utime, channel, bus::encode(message));
  }

 private:
  lcm_eventlog_t* log_;
};

}  // namespace roundabout::logs
