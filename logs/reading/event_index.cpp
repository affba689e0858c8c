#include "logs/reading/event_index.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string_view>
#include <type_traits>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::logs {

namespace {

static_assert(std::endian::native == std::endian::little,
              "the index is written as it is in memory");

constexpr std::string_view kMagic = "RBTINDEX";
constexpr std::uint64_t kVersion = 1;
// Of the log's begin and end, so that another log of the same size and age is not taken for it.
constexpr std::size_t kSampleBytes = 4096;

/// FNV-1a over words of eight bytes.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    sum = (sum ^ word) * 0x100000001b3;
  }
  return sum;
}

/// What must be the same for an index to be this log's.
struct Identity {
  std::uint64_t bytes;
  std::int64_t modified_ns;
  std::uint64_t begin_sum;
  std::uint64_t end_sum;

  bool operator==(const Identity&) const = default;
};

Identity identityOf(const MappedFile& log) {
  const auto bytes = log.bytes();
  const std::size_t sample = std::min(kSampleBytes, bytes.size());
  return {bytes.size(), log.modifiedNs(), checksum(bytes.first(sample)),
          checksum(bytes.last(sample))};
}

class Writer {
 public:
  void text(std::string_view value) { bytes_.append(value); }
  template <class Value>
  void value(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  template <class Value>
  void values(const std::vector<Value>& values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
  }
  std::string finish() {
    value(checksum(std::as_bytes(std::span(bytes_))));
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

/// Reads what Writer wrote; fails, once and for all, where there are too few bytes.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool text(std::string_view expected) {
    const auto part = take(expected.size());
    return ok_ && std::memcmp(part.data(), expected.data(), expected.size()) == 0;
  }
  std::string text(std::size_t size) {
    const auto part = take(size);
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  template <class Value>
  Value value() {
    Value value{};
    const auto part = take(sizeof(Value));
    if (ok_) {
      std::memcpy(&value, part.data(), sizeof(Value));
    }
    return value;
  }
  template <class Value>
  std::vector<Value> values(std::uint64_t count) {
    const bool fits = count <= bytes_.size() / sizeof(Value);
    const auto part = take(fits ? count * sizeof(Value) : bytes_.size() + 1);
    std::vector<Value> values(ok_ ? count : 0);
    if (!values.empty()) {
      std::memcpy(values.data(), part.data(), part.size());
    }
    return values;
  }
  bool ok() const { return ok_; }

 private:
  std::span<const std::byte> take(std::size_t size) {
    ok_ = ok_ && size <= bytes_.size();
    if (!ok_) {
      return {};
    }
    const auto part = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return part;
  }

  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

std::optional<EventScan> parse(std::span<const std::byte> index, const Identity& identity) {
  Reader reader(index);
  if (!reader.text(kMagic) || reader.value<std::uint64_t>() != kVersion ||
      !(reader.value<Identity>() == identity)) {
    return std::nullopt;
  }
  EventScan scan;
  const auto events = reader.value<std::uint64_t>();
  const auto places = reader.value<std::uint64_t>();
  scan.offsets = reader.values<std::size_t>(events);
  scan.log_utimes = reader.values<core::Utime>(events);
  for (std::uint64_t i = 0; i < places && reader.ok(); ++i) {
    Damage place;
    place.offset = reader.value<std::uint64_t>();
    place.bytes = reader.value<std::uint64_t>();
    place.reason = reader.text(reader.value<std::uint64_t>());
    scan.damage.places.push_back(std::move(place));
  }
  return reader.ok() ? std::optional(std::move(scan)) : std::nullopt;
}

}  // namespace

std::string indexFileOf(const std::string& log_file) { return log_file + ".index"; }

std::optional<EventScan> readIndex(const std::string& log_file, const MappedFile& log) {
  try {
    const MappedFile file(indexFileOf(log_file));
    const auto bytes = file.bytes();
    std::uint64_t expected = 0;
    if (bytes.size() <= sizeof(expected)) {
      return std::nullopt;
    }
    const auto content = bytes.first(bytes.size() - sizeof(expected));
    std::memcpy(&expected, bytes.data() + content.size(), sizeof(expected));
    return checksum(content) == expected ? parse(content, identityOf(log)) : std::nullopt;
  } catch (const core::StartupError&) {
    return std::nullopt;
  }
}

bool writeIndex(const std::string& log_file, const MappedFile& log, const EventScan& scan) {
  Writer writer;
  writer.text(kMagic);
  writer.value(kVersion);
  writer.value(identityOf(log));
  writer.value<std::uint64_t>(scan.offsets.size());
  writer.value<std::uint64_t>(scan.damage.places.size());
  writer.values(scan.offsets);
  writer.values(scan.log_utimes);
  for (const Damage& place : scan.damage.places) {
    writer.value<std::uint64_t>(place.offset);
    writer.value<std::uint64_t>(place.bytes);
    writer.value<std::uint64_t>(place.reason.size());
    writer.text(place.reason);
  }
  const std::string bytes = writer.finish();
  const std::string draft = fmt::format("{}.{}", indexFileOf(log_file), getpid());
  std::ofstream stream(draft, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream || std::rename(draft.c_str(), indexFileOf(log_file).c_str()) != 0) {
    std::remove(draft.c_str());
    return false;
  }
  return true;
}

}  // namespace roundabout::logs
