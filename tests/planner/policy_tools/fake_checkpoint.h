#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <leveldb/env.h>
#include <leveldb/options.h>
#include <leveldb/table_builder.h>

#include "planner/nn/safetensors.h"
#include "planner/policy_tools/crc32c.h"

namespace roundabout::planner {

/// Writes checkpoints as TensorFlow does, and wrong ones where a test changes its members first.
class FakeCheckpoint {
 public:
  explicit FakeCheckpoint(const std::string& prefix) : prefix_(prefix) {}

  void add(const std::string& name, const nn::Tensor& tensor) {
    addBytes(name, 1, tensor.shape,
             {reinterpret_cast<const char*>(tensor.values.data()),
              tensor.values.size() * sizeof(float)});
  }

  void addInt(const std::string& name, std::int32_t value) {
    addBytes(name, 3, {}, {reinterpret_cast<const char*>(&value), sizeof(value)});
  }

  void write() const {
    std::ofstream(dataPath(), std::ios::binary) << data_;
    leveldb::WritableFile* opened = nullptr;
    leveldb::Env::Default()->NewWritableFile(indexPath(), &opened);
    const std::unique_ptr<leveldb::WritableFile> file(opened);
    leveldb::Options options;
    options.compression = compression;
    leveldb::TableBuilder builder(options, file.get());
    builder.Add("", header);
    for (const auto& [name, entry] : entries) {
      builder.Add(name, entry);
    }
    builder.Finish();
    file->Close();
  }

  std::string indexPath() const { return prefix_ + ".index"; }
  std::string dataPath() const { return prefix_ + ".data-00000-of-00001"; }

  static std::string varint(std::uint64_t value) {
    std::string bytes;
    for (; value >= 0x80; value >>= 7) {
      bytes += static_cast<char>(value | 0x80);
    }
    return bytes + static_cast<char>(value);
  }

  std::string header = "\x08\x01\x1a\x02\x08\x01";  ///< one data file, producer 1
  std::map<std::string, std::string> entries;       ///< BundleEntryProto
  leveldb::CompressionType compression = leveldb::kNoCompression;

 private:
  void addBytes(const std::string& name, std::uint64_t type, const std::vector<std::int64_t>& shape,
                const std::string& bytes) {
    std::string dimensions;
    for (const std::int64_t size : shape) {
      const std::string dimension = "\x08" + varint(static_cast<std::uint64_t>(size));
      dimensions += "\x12" + varint(dimension.size()) + dimension;
    }
    const std::uint32_t sum = maskedCrc32c(crc32c(bytes));
    entries[name] = "\x08" + varint(type) + "\x12" + varint(dimensions.size()) + dimensions +
                    "\x20" + varint(data_.size()) + "\x28" + varint(bytes.size()) + "\x35" +
                    std::string(reinterpret_cast<const char*>(&sum), sizeof(sum));
    data_ += bytes;
  }

  std::string prefix_;
  std::string data_;
};

}  // namespace roundabout::planner
