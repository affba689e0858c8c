#include "logs/export/mcap.h"

#include <map>

#include "common/bus/messages.h"
#include "common/bus/plausible.h"
#include "logs/export/mcap_writer.h"
#include "logs/types/json_text.h"

namespace roundabout::logs {

namespace {

struct Topic {
  std::uint16_t id;
  const MessageType* type;
  std::uint64_t fingerprint;
};

class Exporter {
 public:
  Exporter(const TypeTable& types, McapClock clock, const std::string& file)
      : types_(types), clock_(clock), writer_(file) {}

  void add(const Event& event) {
    const std::uint64_t fingerprint =
        event.payload.size() < 8 ? 0 : bus::fingerprintOf(event.payload);
    const Topic& topic = topicOf(event.channel, fingerprint);
    const std::uint64_t time_ns = static_cast<std::uint64_t>(timeOf(event)) * 1000;
    text_.clear();
    if (topic.type == nullptr) {
      text_.assign(reinterpret_cast<const char*>(event.payload.data()), event.payload.size());
      ++result_.raw;
    } else if (fingerprint != topic.fingerprint ||
               appendJson(*topic.type, event.payload, text_) != nullptr) {
      ++result_.rejected;
      return;
    }
    writer_.add(topic.id, time_ns, text_);
    ++result_.messages;
  }

  McapResult finish() {
    writer_.finish();
    return result_;
  }

 private:
  core::Utime timeOf(const Event& event) {
    if (clock_ == McapClock::kLog) {
      return event.log_utime;
    }
    if (event.channel == bus::kStatesChannel && event.payload.size() >= 16) {
      const auto utime = static_cast<core::Utime>(bus::bigEndian(event.payload, 8, 8));
      data_utime_ = utime > 0 ? utime : data_utime_;
    }
    return data_utime_;
  }

  const Topic& topicOf(std::string_view channel, std::uint64_t fingerprint) {
    const auto found = topics_.find(channel);
    if (found != topics_.end()) {
      return found->second;
    }
    const MessageType* type = types_.find(fingerprint);
    std::uint16_t schema = 0;
    if (type != nullptr) {
      const auto known = schemas_.find(type);
      schema = known != schemas_.end()
                   ? known->second
                   : writer_.addSchema(type->package + "." + type->name, jsonSchema(*type));
      schemas_[type] = schema;
    }
    const std::string topic(channel);
    const std::uint16_t id = writer_.addChannel(schema, topic, type == nullptr ? "lcm" : "json");
    return topics_.emplace(topic, Topic{id, type, fingerprint}).first->second;
  }

  const TypeTable& types_;
  McapClock clock_;
  McapWriter writer_;
  std::map<std::string, Topic, std::less<>> topics_;
  std::map<const MessageType*, std::uint16_t> schemas_;
  core::Utime data_utime_ = 0;
  std::string text_;
  McapResult result_;
};

}  // namespace

McapResult writeMcap(const EventLog& log, const TypeTable& types, McapClock clock,
                     const std::string& file) {
  Exporter exporter(types, clock, file);
  for (const Event& event : log) {
    exporter.add(event);
  }
  return exporter.finish();
}

}  // namespace roundabout::logs
