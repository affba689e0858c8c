#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "logs/files.h"

namespace roundabout::logs {

/// Writes MCAP files, version 0 of the format, section by section as its specification says
/// (https://mcap.dev/spec). Checksums are 0, which means that there are none.
class McapWriter {
 public:
  /// Throws core::StartupError if the file cannot be made.
  explicit McapWriter(const std::string& file);

  /// Returns its id.
  std::uint16_t addSchema(const std::string& name, const std::string& json_schema);
  /// schema: 0 for none. Returns its id.
  std::uint16_t addChannel(std::uint16_t schema, const std::string& topic,
                           const std::string& encoding);
  /// time: ns since the epoch of the file's choice.
  void add(std::uint16_t channel, std::uint64_t time_ns, std::string_view data);
  /// Throws core::StartupError if not all could be written.
  void finish();

 private:
  struct IndexEntry {
    std::uint64_t time_ns;
    std::uint64_t offset;  // in the chunk
  };
  struct ChunkIndex {
    std::uint64_t begin_ns;
    std::uint64_t end_ns;
    std::uint64_t offset;
    std::uint64_t bytes;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
    std::uint64_t index_bytes;
    std::uint64_t content_bytes;
  };
  struct ChannelCount {
    std::uint32_t sequence = 0;
  };

  void writeChunk();
  std::string statistics() const;
  std::string chunkIndex(const ChunkIndex& chunk) const;

  FileWriter out_;
  std::string schemas_;   // records, again for the summary
  std::string channels_;  // the same
  std::uint16_t num_schemas_ = 0;
  std::map<std::uint16_t, ChannelCount> counts_;
  std::string chunk_;
  std::map<std::uint16_t, std::vector<IndexEntry>> chunk_messages_;
  std::uint64_t chunk_begin_ns_ = 0;
  std::uint64_t chunk_end_ns_ = 0;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace roundabout::logs
