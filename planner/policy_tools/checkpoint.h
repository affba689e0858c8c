#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "planner/nn/safetensors.h"

namespace roundabout::planner {

/// A TensorFlow V2 checkpoint: PREFIX.index, a table in LevelDB's format whose values are
/// BundleEntryProto messages, and PREFIX.data-00000-of-00001 with the tensors' bytes
/// (tensorflow/core/protobuf/tensor_bundle.proto). Every block of the index and every tensor that
/// is read is checked against its sum. All functions throw core::StartupError.
class Checkpoint {
 public:
  /// Reads the index. Refused: missing, damaged, big-endian, more than one data file.
  explicit Checkpoint(const std::string& prefix);

  /// A float32 tensor. Refused: not there (the error lists what is), of another type, truncated,
  /// not as its sum says.
  nn::Tensor readFloats(const std::string& name) const;

  /// An int32 scalar; refused as above.
  std::int32_t readInt(const std::string& name) const;

 private:
  struct Entry {
    std::uint64_t type = 0;
    std::vector<std::int64_t> shape;
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    std::uint64_t masked_crc = 0;
  };

  static void checkHeader(const std::string& path, const std::string& message);
  static Entry parseEntry(const std::string& path, const std::string& name,
                          const std::string& message);
  const Entry& entry(const std::string& name) const;
  std::string readBytes(const std::string& name, std::uint64_t type, std::uint64_t bytes) const;

  std::string index_path_;
  std::string data_path_;
  std::map<std::string, Entry> entries_;
};

}  // namespace roundabout::planner
