#include "planner/nn/safetensors.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/core/error.h"

namespace roundabout::planner::nn {

static_assert(std::endian::native == std::endian::little, "safetensors are little-endian");

namespace {

using core::StartupError;
using nlohmann::json;

constexpr std::string_view kMetadataKey = "__metadata__";
constexpr std::size_t kLengthBytes = sizeof(std::uint64_t);
constexpr std::uint64_t kMaxHeaderBytes = 1 << 20;

/// A tensor's place in the data, in bytes.
struct Extent {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::string name;
};

/// The stored numbers in single precision.
template <class Stored>
std::vector<float> numbersOf(std::string_view bytes) {
  std::vector<float> numbers(bytes.size() / sizeof(Stored));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Stored number;
    std::memcpy(&number, bytes.data() + i * sizeof(Stored), sizeof(Stored));
    numbers[i] = static_cast<float>(number);
  }
  return numbers;
}

class Reader {
 public:
  explicit Reader(std::string path) : path_(std::move(path)) {}

  TensorFile read() {
    load();
    const json header = parseHeader();
    TensorFile file;
    std::vector<Extent> extents;
    for (const auto& [name, entry] : header.items()) {
      if (name == kMetadataKey) {
        file.metadata = parseMetadata(entry);
      } else {
        extents.push_back(parseTensor(name, entry, file.tensors[name]));
      }
    }
    checkCoverage(extents);
    return file;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected,
                         const std::string& found) const {
    throw StartupError(path_, what, expected, found);
  }

  void load() {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path_, error);
    std::ifstream stream(path_, std::ios::binary);
    if (error || !stream) {
      fail("weights", "a safetensors file", error ? error.message() : "one that cannot be opened");
    }
    bytes_.resize(bytes);
    stream.read(bytes_.data(), static_cast<std::streamsize>(bytes));
    if (!stream) {
      fail("weights", fmt::format("{} bytes", bytes), fmt::format("{}", stream.gcount()));
    }
  }

  json parseHeader() {
    if (bytes_.size() < kLengthBytes) {
      fail("header", "8 bytes with its length", fmt::format("a file of {} bytes", bytes_.size()));
    }
    std::uint64_t header_bytes = 0;
    std::memcpy(&header_bytes, bytes_.data(), kLengthBytes);
    if (header_bytes > kMaxHeaderBytes) {
      fail("header", fmt::format("at most {} bytes", kMaxHeaderBytes),
           fmt::format("{} bytes", header_bytes));
    }
    if (header_bytes > bytes_.size() - kLengthBytes) {
      fail("header", fmt::format("{} bytes", header_bytes),
           fmt::format("{} bytes before the end of the file", bytes_.size() - kLengthBytes));
    }
    const std::string_view text(bytes_.data() + kLengthBytes, header_bytes);
    data_ = std::string_view(bytes_).substr(kLengthBytes + header_bytes);
    const json header = json::parse(text, nullptr, false);
    if (!header.is_object()) {
      fail("header", "a JSON object", header.is_discarded() ? "no JSON" : header.type_name());
    }
    return header;
  }

  std::map<std::string, std::string> parseMetadata(const json& entry) const {
    std::map<std::string, std::string> metadata;
    if (!entry.is_object()) {
      fail("metadata", "a JSON object", entry.type_name());
    }
    for (const auto& [key, value] : entry.items()) {
      if (!value.is_string()) {
        fail("metadata " + key, "a string", value.type_name());
      }
      metadata[key] = value.get<std::string>();
    }
    return metadata;
  }

  static bool isListOfSizes(const json& entry) {
    return entry.is_array() && std::all_of(entry.begin(), entry.end(), [](const json& each) {
             return each.is_number_unsigned() && each.get<std::uint64_t>() <= std::uint64_t{1}
                                                                                  << 32;
           });
  }

  Extent parseTensor(const std::string& name, const json& entry, Tensor& tensor) const {
    const std::string what = "tensor " + name;
    for (const char* key : {"dtype", "shape", "data_offsets"}) {
      if (!entry.is_object() || !entry.contains(key)) {
        fail(what, "an entry with dtype, shape and data_offsets", entry.dump());
      }
    }
    const bool is_double = entry["dtype"] == "F64";
    if (!is_double && entry["dtype"] != "F32") {
      fail(what, "dtype \"F32\" or \"F64\"", entry["dtype"].dump());
    }
    if (!isListOfSizes(entry["shape"])) {
      fail(what, "a shape of numbers from 0 on", entry["shape"].dump());
    }
    const json& offsets = entry["data_offsets"];
    if (!isListOfSizes(offsets) || offsets.size() != 2 || offsets[0] > offsets[1] ||
        offsets[1] > data_.size()) {
      fail(what, fmt::format("data_offsets [begin, end] within {} bytes of data", data_.size()),
           offsets.dump());
    }
    tensor.shape = entry["shape"].get<std::vector<std::int64_t>>();
    const Extent extent{offsets[0], offsets[1], name};
    const std::uint64_t bytes = extent.end - extent.begin;
    std::uint64_t count = 1;
    for (const std::int64_t size : tensor.shape) {
      // Any count beyond the data's is wrong: stop before it overflows.
      count = std::min<std::uint64_t>(count, data_.size() + 1) * static_cast<std::uint64_t>(size);
    }
    const std::uint64_t number_bytes = is_double ? sizeof(double) : sizeof(float);
    if (bytes % number_bytes != 0 || count != bytes / number_bytes) {
      fail(what,
           fmt::format("{} bytes for each number of shape {}", number_bytes,
                       shapeText(tensor.shape)),
           fmt::format("{} bytes", bytes));
    }
    const std::string_view content = data_.substr(extent.begin, bytes);
    tensor.values = is_double ? numbersOf<double>(content) : numbersOf<float>(content);
    return extent;
  }

  void checkCoverage(std::vector<Extent>& extents) const {
    std::sort(extents.begin(), extents.end(), [](const Extent& left, const Extent& right) {
      return std::pair(left.begin, left.end) < std::pair(right.begin, right.end);
    });
    std::uint64_t filled = 0;
    for (const Extent& extent : extents) {
      if (extent.begin != filled) {
        fail("tensor " + extent.name, fmt::format("data from byte {} on", filled),
             fmt::format("{} from byte {} on", extent.begin < filled ? "an overlap" : "a gap",
                         extent.begin));
      }
      filled = extent.end;
    }
    if (filled != data_.size()) {
      fail("data", fmt::format("{} bytes", filled),
           fmt::format("{} bytes left over", data_.size() - filled));
    }
  }

  std::string path_;
  std::string bytes_;
  std::string_view data_;
};

std::string headerOf(const TensorFile& file) {
  json header = json::object();
  header[kMetadataKey] = file.metadata;
  std::uint64_t offset = 0;
  for (const auto& [name, tensor] : file.tensors) {
    const std::uint64_t end = offset + tensor.values.size() * sizeof(float);
    header[name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {offset, end}}};
    offset = end;
  }
  std::string text = header.dump();
  // The data begins at a multiple of eight bytes, so that it can be mapped into memory.
  text.resize((text.size() + 7) / 8 * 8, ' ');
  return text;
}

}  // namespace

TensorFile readSafetensors(const std::string& path) { return Reader(path).read(); }

void writeSafetensors(const std::string& path, const TensorFile& file) {
  const std::string header = headerOf(file);
  const std::uint64_t header_bytes = header.size();
  const std::string unfinished = path + ".part";
  std::ofstream stream(unfinished, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(&header_bytes), kLengthBytes);
  stream << header;
  for (const auto& [name, tensor] : file.tensors) {
    stream.write(reinterpret_cast<const char*>(tensor.values.data()),
                 static_cast<std::streamsize>(tensor.values.size() * sizeof(float)));
  }
  stream.close();
  if (!stream || std::rename(unfinished.c_str(), path.c_str()) != 0) {
    const std::string reason = std::strerror(errno);
    std::remove(unfinished.c_str());
    throw StartupError(path, "weights", "a file that can be written", reason);
  }
}

std::string shapeText(const std::vector<std::int64_t>& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

}  // namespace roundabout::planner::nn
