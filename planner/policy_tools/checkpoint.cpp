#include "planner/policy_tools/checkpoint.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string_view>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/core/error.h"
#include "planner/policy_tools/crc32c.h"
#include "planner/policy_tools/leveldb_table.h"
#include "planner/policy_tools/protobuf_wire.h"

namespace roundabout::planner {

namespace {

using core::StartupError;

// tensorflow/core/framework/types.proto
constexpr std::uint64_t kFloat32 = 1;
constexpr std::uint64_t kInt32 = 3;
/// Beyond any tensor: what is larger is damaged, and products of it would overflow.
constexpr std::uint64_t kMaxSize = std::uint64_t{1} << 31;

std::vector<WireField> fieldsOf(const std::string& path, const std::string& what,
                                std::string_view message) {
  const auto fields = parseMessage(message);
  if (!fields) {
    throw StartupError(path, what, "a protocol buffer", "a malformed one");
  }
  return *fields;
}

/// TensorShapeProto: field 2 is a dimension, whose field 1 is its size.
std::vector<std::int64_t> parseShape(const std::string& path, const std::string& what,
                                     std::string_view message) {
  std::vector<std::int64_t> shape;
  for (const WireField& dimension : fieldsOf(path, what, message)) {
    if (dimension.number != 2) {
      continue;
    }
    std::uint64_t size = 0;
    for (const WireField& field : fieldsOf(path, what, dimension.bytes)) {
      size = field.number == 1 ? field.value : size;
    }
    if (size > kMaxSize) {
      throw StartupError(path, what, fmt::format("sizes up to {}", kMaxSize), std::to_string(size));
    }
    shape.push_back(static_cast<std::int64_t>(size));
  }
  return shape;
}

std::uint64_t elementCount(const std::vector<std::int64_t>& shape) {
  std::uint64_t count = 1;
  for (const std::int64_t size : shape) {
    count = std::min(count, kMaxSize) * static_cast<std::uint64_t>(size);
  }
  return count;
}

}  // namespace

Checkpoint::Checkpoint(const std::string& prefix)
    : index_path_(prefix + ".index"), data_path_(prefix + ".data-00000-of-00001") {
  // The empty key is the header's.
  std::map<std::string, std::string> table = readTable(index_path_);
  checkHeader(index_path_, table[""]);
  table.erase("");
  for (const auto& [name, message] : table) {
    entries_.emplace(name, parseEntry(index_path_, name, message));
  }
}

void Checkpoint::checkHeader(const std::string& path, const std::string& message) {
  std::uint64_t data_files = 0;
  std::uint64_t endianness = 0;
  for (const WireField& field : fieldsOf(path, "checkpoint header", message)) {
    data_files = field.number == 1 ? field.value : data_files;
    endianness = field.number == 2 ? field.value : endianness;
  }
  if (data_files != 1 || endianness != 0) {
    throw StartupError(path, "checkpoint header", "1 data file, little-endian",
                       fmt::format("{} data files, {}", data_files,
                                   endianness == 0 ? "little-endian" : "big-endian"));
  }
}

Checkpoint::Entry Checkpoint::parseEntry(const std::string& path, const std::string& name,
                                         const std::string& message) {
  const std::string what = "entry " + name;
  Entry entry;
  for (const WireField& field : fieldsOf(path, what, message)) {
    switch (field.number) {
      case 1:
        entry.type = field.value;
        break;
      case 2:
        entry.shape = parseShape(path, what, field.bytes);
        break;
      case 4:
        entry.offset = field.value;
        break;
      case 5:
        entry.bytes = field.value;
        break;
      case 6:
        entry.masked_crc = field.value;
        break;
      default:
        break;
    }
  }
  return entry;
}

const Checkpoint::Entry& Checkpoint::entry(const std::string& name) const {
  const auto entry = entries_.find(name);
  if (entry == entries_.end()) {
    std::vector<std::string_view> names;
    for (const auto& [each, its_entry] : entries_) {
      names.push_back(each);
    }
    throw StartupError(index_path_, "tensor " + name, "to be there",
                       fmt::format("only {}", fmt::join(names, ", ")));
  }
  return entry->second;
}

std::string Checkpoint::readBytes(const std::string& name, std::uint64_t type,
                                  std::uint64_t bytes) const {
  const std::string what = "tensor " + name;
  const Entry& its_entry = entry(name);
  if (its_entry.type != type || its_entry.bytes != bytes) {
    throw StartupError(index_path_, what,
                       fmt::format("type {} (types.proto), {} bytes", type, bytes),
                       fmt::format("type {}, {} bytes", its_entry.type, its_entry.bytes));
  }
  std::ifstream stream(data_path_, std::ios::binary);
  if (!stream) {
    throw StartupError(data_path_, "checkpoint data", "a readable file", "none");
  }
  std::string content(bytes, '\0');
  stream.seekg(static_cast<std::streamoff>(its_entry.offset));
  stream.read(content.data(), static_cast<std::streamsize>(bytes));
  if (!stream) {
    throw StartupError(data_path_, what,
                       fmt::format("{} bytes from byte {} on", bytes, its_entry.offset),
                       fmt::format("{} bytes before the end of the file", stream.gcount()));
  }
  const std::uint32_t sum = maskedCrc32c(crc32c(content));
  if (sum != its_entry.masked_crc) {
    throw StartupError(data_path_, what, fmt::format("masked CRC-32C {:08x}", its_entry.masked_crc),
                       fmt::format("{:08x}", sum));
  }
  return content;
}

nn::Tensor Checkpoint::readFloats(const std::string& name) const {
  nn::Tensor tensor;
  tensor.shape = entry(name).shape;
  const std::uint64_t count = elementCount(tensor.shape);
  const std::string content = readBytes(name, kFloat32, count * sizeof(float));
  tensor.values.resize(count);
  std::memcpy(tensor.values.data(), content.data(), content.size());
  return tensor;
}

std::int32_t Checkpoint::readInt(const std::string& name) const {
  std::int32_t value = 0;
  std::memcpy(&value, readBytes(name, kInt32, sizeof(value)).data(), sizeof(value));
  return value;
}

}  // namespace roundabout::planner
