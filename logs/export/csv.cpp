#include "logs/export/csv.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>

#include <spdlog/fmt/fmt.h>

#include "common/bus/plausible.h"
#include "logs/export/csv_table.h"
#include "logs/report/html.h"
#include "logs/types/walk.h"

namespace roundabout::logs {

namespace {

/// How long each list of a type gets, by the path of its member ("vehicles[].position[]").
using Lengths = std::map<std::string, std::size_t, std::less<>>;

/// Knows at each value by which path it is reached.
class PathVisitor : public MessageVisitor {
 public:
  void member(const Member& member) override { path_ = prefix_ + member.name; }
  void beginList(std::size_t count) override {
    path_ += "[]";
    onList(path_, count);
    counts_.push_back(count);
  }
  void endList() override {
    onListEnd(path_, counts_.back());
    counts_.pop_back();
    path_.resize(path_.size() - 2);
  }
  void beginMessage(const MessageType&) override {
    prefixes_.push_back(prefix_);
    paths_.push_back(path_);
    prefix_ = path_ + ".";
  }
  void endMessage() override {
    path_ = paths_.back();
    prefix_ = prefixes_.back();
    paths_.pop_back();
    prefixes_.pop_back();
  }

 protected:
  virtual void onList(const std::string& path, std::size_t count) = 0;
  virtual void onListEnd(const std::string& path, std::size_t count) = 0;

 private:
  std::string path_;
  std::string prefix_;
  std::vector<std::string> paths_;
  std::vector<std::string> prefixes_;
  std::vector<std::size_t> counts_;
};

class Measure final : public PathVisitor {
 public:
  explicit Measure(Lengths& lengths) : lengths_(lengths) {}
  void integer(std::int64_t) override {}
  void real(double, int) override {}
  void boolean(bool) override {}
  void text(std::string_view) override {}
  void bytes(std::span<const std::byte>) override {}

 private:
  void onList(const std::string& path, std::size_t count) override {
    std::size_t& length = lengths_[path];
    length = std::max(length, count);
  }
  void onListEnd(const std::string&, std::size_t) override {}

  Lengths& lengths_;
};

/// Calls for each column of a type with its name; lists are as long as the longest.
void forEachColumn(const MessageType& type, const Lengths& lengths, const std::string& path,
                   const std::string& name,
                   const std::function<void(const std::string&, const Member&)>& column) {
  for (const Member& member : type.members) {
    std::function<void(std::size_t, const std::string&, const std::string&)> spread =
        [&](std::size_t level, const std::string& at, const std::string& called) {
          const bool whole = member.primitive == Primitive::kByte &&
                             level + 1 == member.dimensions.size() && level == 0;
          if (level < member.dimensions.size() && !whole) {
            const auto length = lengths.find(at + "[]");
            for (std::size_t i = 0; length != lengths.end() && i < length->second; ++i) {
              spread(level + 1, at + "[]", fmt::format("{}[{}]", called, i));
            }
          } else if (member.message != nullptr) {
            forEachColumn(*member.message, lengths, at + ".", called + ".", column);
          } else {
            column(called, member);
          }
        };
    spread(0, path + member.name, name + member.name);
  }
}

class RowWriter final : public PathVisitor {
 public:
  RowWriter(CsvTable& table, const Lengths& lengths,
            const std::map<std::string, std::size_t>& widths)
      : table_(table), lengths_(lengths), widths_(widths) {}

  void integer(std::int64_t value) override { table_.integer(value); }
  void real(double value, int digits) override {
    if (digits < 10) {
      table_.real(static_cast<float>(value));
    } else {
      table_.real(value);
    }
  }
  void boolean(bool value) override { table_.integer(value ? 1 : 0); }
  void text(std::string_view value) override { table_.text(value); }
  void bytes(std::span<const std::byte> value) override {
    table_.text(base64({reinterpret_cast<const char*>(value.data()), value.size()}));
  }

 private:
  void onList(const std::string&, std::size_t) override {}
  void onListEnd(const std::string& path, std::size_t count) override {
    const std::size_t missing = lengths_.find(path)->second - count;
    for (std::size_t i = missing * widths_.at(path); i > 0; --i) {
      table_.blank();
    }
  }

  CsvTable& table_;
  const Lengths& lengths_;
  const std::map<std::string, std::size_t>& widths_;  // columns of one element
};

/// Columns of one element of each list.
std::map<std::string, std::size_t> widthsOf(const MessageType& type, const Lengths& lengths) {
  std::map<std::string, std::size_t> widths;
  std::function<std::size_t(const MessageType&, const std::string&)> of_type =
      [&](const MessageType& of, const std::string& path) {
        std::size_t columns = 0;
        for (const Member& member : of.members) {
          const bool whole = member.primitive == Primitive::kByte && member.dimensions.size() == 1;
          const std::size_t levels = whole ? 0 : member.dimensions.size();
          std::string at = path + member.name;
          for (std::size_t i = 0; i < levels; ++i) {
            at += "[]";
          }
          std::size_t width = member.message == nullptr ? 1 : of_type(*member.message, at + ".");
          for (std::size_t i = 0; i < levels; ++i) {
            widths[at] = width;
            const auto length = lengths.find(at);
            width *= length == lengths.end() ? 0 : length->second;
            at.resize(at.size() - 2);
          }
          columns += width;
        }
        return columns;
      };
  of_type(type, "");
  return widths;
}

std::string withUnit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

/// The messages of one channel.
struct ChannelEvents {
  const MessageType* type = nullptr;
  std::uint64_t fingerprint = 0;
  std::vector<std::size_t> events;
};

std::uint64_t fingerprintIn(const Event& event) {
  return event.payload.size() < 8 ? 0 : bus::fingerprintOf(event.payload);
}

CsvFile writeChannel(const EventLog& log, const std::string& channel, const ChannelEvents& of,
                     const std::string& folder) {
  CsvFile result;
  result.channel = channel;
  if (of.type == nullptr) {
    result.problem =
        fmt::format("type {:016x} is not known: name its .lcm file with --types", of.fingerprint);
    return result;
  }
  Lengths lengths;
  Lengths in_message;
  std::vector<std::size_t> sound;
  for (const std::size_t index : of.events) {
    const Event event = log[index];
    Measure measure(in_message);
    if (fingerprintIn(event) == of.fingerprint &&
        walk(*of.type, event.payload, measure) == nullptr) {
      sound.push_back(index);
      for (const auto& [path, length] : in_message) {
        lengths[path] = std::max(lengths[path], length);
      }
    } else {
      in_message.clear();  // of a message that does not decode no list may count
    }
  }
  result.rejected = of.events.size() - sound.size();
  std::vector<std::string> header{"log_time (s)", "log_utime (us)"};
  forEachColumn(*of.type, lengths, "", "", [&](const std::string& name, const Member& member) {
    header.push_back(withUnit(name, member.unit));
  });
  result.file = (std::filesystem::path(folder) / (channel + ".csv")).string();
  CsvTable table(result.file, header);
  const auto widths = widthsOf(*of.type, lengths);
  for (const std::size_t index : sound) {
    const Event event = log[index];
    table.fixed(core::toSeconds(event.log_utime - log.logUtime(0)), 6);
    table.integer(event.log_utime);
    RowWriter writer(table, lengths, widths);
    walk(*of.type, event.payload, writer);
    table.endRow();
  }
  table.finish();
  result.rows = sound.size();
  return result;
}

}  // namespace

std::vector<CsvFile> writeChannelTables(const EventLog& log, const TypeTable& types,
                                        const std::string& folder) {
  std::map<std::string, ChannelEvents, std::less<>> channels;
  for (std::size_t i = 0; i < log.size(); ++i) {
    const Event event = log[i];
    auto found = channels.find(event.channel);
    if (found == channels.end()) {
      found = channels.emplace(std::string(event.channel), ChannelEvents()).first;
    }
    ChannelEvents& channel = found->second;
    if (channel.type == nullptr) {
      channel.fingerprint = fingerprintIn(event);
      channel.type = types.find(channel.fingerprint);
    }
    channel.events.push_back(i);
  }
  std::vector<CsvFile> files;
  for (const auto& [channel, events] : channels) {
    files.push_back(writeChannel(log, channel, events, folder));
  }
  return files;
}

}  // namespace roundabout::logs
