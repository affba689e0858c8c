#include "logs/export/mcap_writer.h"

#include <algorithm>
#include <initializer_list>
#include <numeric>

namespace roundabout::logs {

namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = 256 << 10;

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// Little-endian, of the given size.
void put(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) {
    bytes += static_cast<char>(value >> (8 * i));
  }
}
void put2(std::string& bytes, std::uint64_t value) { put(bytes, value, 2); }
void put4(std::string& bytes, std::uint64_t value) { put(bytes, value, 4); }
void put8(std::string& bytes, std::uint64_t value) { put(bytes, value, 8); }

void putText(std::string& bytes, std::string_view text) {
  put4(bytes, text.size());
  bytes += text;
}

std::string record(Opcode opcode, std::string_view content) {
  std::string bytes(1, static_cast<char>(opcode));
  put8(bytes, content.size());
  bytes += content;
  return bytes;
}

}  // namespace

McapWriter::McapWriter(const std::string& file) : out_(file) {
  out_.write(kMagic);
  std::string header;
  putText(header, "");
  putText(header, "roundabout");
  out_.write(record(Opcode::kHeader, header));
}

std::uint16_t McapWriter::addSchema(const std::string& name, const std::string& json_schema) {
  std::string content;
  put2(content, ++num_schemas_);
  putText(content, name);
  putText(content, "jsonschema");
  putText(content, json_schema);
  const std::string bytes = record(Opcode::kSchema, content);
  schemas_ += bytes;
  chunk_ += bytes;
  return num_schemas_;
}

std::uint16_t McapWriter::addChannel(std::uint16_t schema, const std::string& topic,
                                     const std::string& encoding) {
  const auto id = static_cast<std::uint16_t>(counts_.size());
  std::string content;
  put2(content, id);
  put2(content, schema);
  putText(content, topic);
  putText(content, encoding);
  put4(content, 0);  // no metadata
  const std::string bytes = record(Opcode::kChannel, content);
  channels_ += bytes;
  chunk_ += bytes;
  counts_[id] = {};
  return id;
}

void McapWriter::add(std::uint16_t channel, std::uint64_t time_ns, std::string_view data) {
  const bool first = chunk_messages_.empty();
  chunk_begin_ns_ = first ? time_ns : std::min(chunk_begin_ns_, time_ns);
  chunk_end_ns_ = first ? time_ns : std::max(chunk_end_ns_, time_ns);
  chunk_messages_[channel].push_back({time_ns, chunk_.size()});
  chunk_ += static_cast<char>(Opcode::kMessage);
  put8(chunk_, 2 + 4 + 8 + 8 + data.size());
  put2(chunk_, channel);
  put4(chunk_, counts_[channel].sequence++);
  put8(chunk_, time_ns);
  put8(chunk_, time_ns);
  chunk_ += data;
  if (chunk_.size() >= kChunkBytes) {
    writeChunk();
  }
}

void McapWriter::writeChunk() {
  ChunkIndex index{chunk_begin_ns_, chunk_end_ns_, out_.written(), 0, {}, 0, chunk_.size()};
  std::string content;
  put8(content, chunk_begin_ns_);
  put8(content, chunk_end_ns_);
  put8(content, chunk_.size());
  put4(content, 0);
  putText(content, "");
  put8(content, chunk_.size());
  content += chunk_;
  out_.write(record(Opcode::kChunk, content));
  index.bytes = out_.written() - index.offset;
  const std::uint64_t indices = out_.written();
  for (const auto& [channel, entries] : chunk_messages_) {
    index.index_offsets[channel] = out_.written();
    std::string messages;
    put2(messages, channel);
    put4(messages, entries.size() * 16);
    for (const IndexEntry& entry : entries) {
      put8(messages, entry.time_ns);
      put8(messages, entry.offset);
    }
    out_.write(record(Opcode::kMessageIndex, messages));
  }
  index.index_bytes = out_.written() - indices;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_messages_.clear();
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : counts_) {
    messages += count.sequence;
  }
  std::uint64_t begin_ns = chunks_.empty() ? 0 : chunks_.front().begin_ns;
  std::uint64_t end_ns = 0;
  for (const ChunkIndex& chunk : chunks_) {
    begin_ns = std::min(begin_ns, chunk.begin_ns);
    end_ns = std::max(end_ns, chunk.end_ns);
  }
  std::string content;
  put8(content, messages);
  put2(content, num_schemas_);
  put4(content, counts_.size());
  put4(content, 0);  // attachments
  put4(content, 0);  // metadata
  put4(content, chunks_.size());
  put8(content, begin_ns);
  put8(content, end_ns);
  put4(content, counts_.size() * 10);
  for (const auto& [channel, count] : counts_) {
    put2(content, channel);
    put8(content, count.sequence);
  }
  return record(Opcode::kStatistics, content);
}

std::string McapWriter::chunkIndex(const ChunkIndex& chunk) const {
  std::string content;
  put8(content, chunk.begin_ns);
  put8(content, chunk.end_ns);
  put8(content, chunk.offset);
  put8(content, chunk.bytes);
  put4(content, chunk.index_offsets.size() * 10);
  for (const auto& [channel, offset] : chunk.index_offsets) {
    put2(content, channel);
    put8(content, offset);
  }
  put8(content, chunk.index_bytes);
  putText(content, "");
  put8(content, chunk.content_bytes);
  put8(content, chunk.content_bytes);
  return record(Opcode::kChunkIndex, content);
}

void McapWriter::finish() {
  if (!chunk_.empty()) {
    writeChunk();
  }
  std::string data_end;
  put4(data_end, 0);
  out_.write(record(Opcode::kDataEnd, data_end));

  const std::uint64_t summary = out_.written();
  std::string offsets;
  const auto group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) {
      return;
    }
    std::string offset(1, static_cast<char>(opcode));
    put8(offset, out_.written());
    put8(offset, records.size());
    offsets += record(Opcode::kSummaryOffset, offset);
    out_.write(records);
  };
  group(Opcode::kSchema, schemas_);
  group(Opcode::kChannel, channels_);
  group(Opcode::kStatistics, statistics());
  std::string indices;
  for (const ChunkIndex& chunk : chunks_) {
    indices += chunkIndex(chunk);
  }
  group(Opcode::kChunkIndex, indices);
  const std::uint64_t summary_offsets = out_.written();
  out_.write(offsets);

  std::string footer;
  put8(footer, summary);
  put8(footer, summary_offsets);
  put4(footer, 0);
  out_.write(record(Opcode::kFooter, footer));
  out_.write(kMagic);
  out_.finish();
}

}  // namespace roundabout::logs
