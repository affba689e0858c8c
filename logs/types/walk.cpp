#include "logs/types/walk.h"

#include <bit>
#include <limits>
#include <vector>

#include "common/bus/plausible.h"

namespace roundabout::logs {

namespace {

constexpr int kDeepest = 16;
constexpr const char* kTruncated = "truncated";

class Walk {
 public:
  Walk(std::span<const std::byte> bytes, MessageVisitor& visitor)
      : bytes_(bytes), visitor_(visitor) {}

  const char* message(const MessageType& type, int depth) {
    if (depth > kDeepest) {
      return "messages within messages, too deep";
    }
    std::vector<std::int64_t> integers(type.members.size(), -1);
    for (std::size_t i = 0; i < type.members.size(); ++i) {
      const Member& member = type.members[i];
      std::vector<std::size_t> counts;
      for (const Dimension& dimension : member.dimensions) {
        const std::int64_t count = countOf(type, dimension, integers);
        if (count < 0 || count > static_cast<std::int64_t>(bytes_.size())) {
          return "counts larger than the message";
        }
        counts.push_back(static_cast<std::size_t>(count));
      }
      visitor_.member(member);
      if (const char* problem = list(member, counts, integers[i], depth)) {
        return problem;
      }
    }
    return nullptr;
  }

  std::size_t left() const { return bytes_.size() - at_; }
  void skip(std::size_t bytes) { at_ += bytes; }

 private:
  static std::int64_t countOf(const MessageType& type, const Dimension& dimension,
                              const std::vector<std::int64_t>& integers) {
    if (dimension.constant) {
      return static_cast<std::int64_t>(*dimension.constant);
    }
    for (std::size_t i = 0; i < type.members.size(); ++i) {
      if (type.members[i].name == dimension.size) {
        return integers[i];
      }
    }
    return -1;
  }

  const char* list(const Member& member, std::span<const std::size_t> counts, std::int64_t& integer,
                   int depth) {
    if (counts.empty()) {
      return value(member, integer, depth);
    }
    if (counts.size() == 1 && member.primitive == Primitive::kByte) {
      if (counts[0] > left()) {
        return kTruncated;
      }
      visitor_.bytes(bytes_.subspan(at_, counts[0]));
      skip(counts[0]);
      return nullptr;
    }
    visitor_.beginList(counts[0]);
    for (std::size_t i = 0; i < counts[0]; ++i) {
      if (left() == 0) {
        return kTruncated;
      }
      if (const char* problem = list(member, counts.subspan(1), integer, depth)) {
        return problem;
      }
    }
    visitor_.endList();
    return nullptr;
  }

  const char* value(const Member& member, std::int64_t& integer, int depth) {
    if (member.message != nullptr) {
      visitor_.beginMessage(*member.message);
      const char* problem = message(*member.message, depth + 1);
      if (problem == nullptr) {
        visitor_.endMessage();
      }
      return problem;
    }
    const Primitive primitive = *member.primitive;
    if (primitive == Primitive::kString) {
      return text();
    }
    const std::size_t size = bytesOf(primitive);
    if (size > left()) {
      return kTruncated;
    }
    const std::uint64_t raw = bus::bigEndian(bytes_, at_, size);
    skip(size);
    scalar(primitive, raw, integer);
    return nullptr;
  }

  void scalar(Primitive primitive, std::uint64_t raw, std::int64_t& integer) {
    switch (primitive) {
      case Primitive::kInt8:
        integer = static_cast<std::int8_t>(raw);
        break;
      case Primitive::kInt16:
        integer = static_cast<std::int16_t>(raw);
        break;
      case Primitive::kInt32:
        integer = static_cast<std::int32_t>(raw);
        break;
      case Primitive::kInt64:
      case Primitive::kByte:
        integer = static_cast<std::int64_t>(raw);
        break;
      case Primitive::kFloat:
        visitor_.real(std::bit_cast<float>(static_cast<std::uint32_t>(raw)),
                      std::numeric_limits<float>::max_digits10);
        return;
      case Primitive::kDouble:
        visitor_.real(std::bit_cast<double>(raw), std::numeric_limits<double>::max_digits10);
        return;
      case Primitive::kBoolean:
        visitor_.boolean(raw != 0);
        return;
      case Primitive::kString:
        return;
    }
    visitor_.integer(integer);
  }

  const char* text() {
    if (left() < 4) {
      return kTruncated;
    }
    const std::uint64_t size = bus::bigEndian(bytes_, at_, 4);
    skip(4);
    // The count includes the terminator.
    if (size < 1 || size > left()) {
      return "a text longer than the message";
    }
    visitor_.text(
        {reinterpret_cast<const char*>(bytes_.data() + at_), static_cast<std::size_t>(size - 1)});
    skip(static_cast<std::size_t>(size));
    return nullptr;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  MessageVisitor& visitor_;
};

}  // namespace

const char* walk(const MessageType& type, std::span<const std::byte> payload,
                 MessageVisitor& visitor) {
  constexpr std::size_t kFingerprintBytes = 8;
  if (payload.size() < kFingerprintBytes) {
    return "shorter than a fingerprint";
  }
  Walk walk(payload, visitor);
  walk.skip(kFingerprintBytes);
  if (const char* problem = walk.message(type, 0)) {
    return problem;
  }
  return walk.left() == 0 ? nullptr : "bytes left over";
}

}  // namespace roundabout::logs
