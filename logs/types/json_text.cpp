#include "logs/types/json_text.h"

#include <cmath>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "logs/report/html.h"
#include "logs/types/walk.h"

namespace roundabout::logs {

namespace {

using Json = nlohmann::ordered_json;

class JsonWriter final : public MessageVisitor {
 public:
  explicit JsonWriter(std::string& text) : text_(text) { text_ += '{'; }

  void member(const Member& member) override {
    comma();
    text_ += '"';
    text_ += member.name;
    text_ += "\":";
    fresh_ = true;
  }
  void integer(std::int64_t value) override {
    comma();
    fmt::format_to(std::back_inserter(text_), "{}", value);
  }
  void real(double value, int digits) override {
    comma();
    if (!std::isfinite(value)) {
      text_ += "null";
    } else if (digits < 10) {
      fmt::format_to(std::back_inserter(text_), "{}", static_cast<float>(value));
    } else {
      fmt::format_to(std::back_inserter(text_), "{}", value);
    }
  }
  void boolean(bool value) override {
    comma();
    text_ += value ? "true" : "false";
  }
  void text(std::string_view value) override {
    comma();
    text_ += jsonString(value);
  }
  void bytes(std::span<const std::byte> value) override {
    comma();
    text_ += '"';
    text_ += base64({reinterpret_cast<const char*>(value.data()), value.size()});
    text_ += '"';
  }
  void beginList(std::size_t) override { open('['); }
  void endList() override { close(']'); }
  void beginMessage(const MessageType&) override { open('{'); }
  void endMessage() override { close('}'); }

 private:
  void comma() {
    if (!fresh_) {
      text_ += ',';
    }
    fresh_ = false;
  }
  void open(char bracket) {
    comma();
    text_ += bracket;
    fresh_ = true;
  }
  void close(char bracket) {
    text_ += bracket;
    fresh_ = false;
  }

  std::string& text_;
  bool fresh_ = true;  // nothing to separate the next value from
};

Json schemaOf(const MessageType& type, int depth);

Json schemaOf(const Member& member, int depth) {
  Json schema;
  if (member.message != nullptr) {
    schema = schemaOf(*member.message, depth + 1);
  } else {
    switch (*member.primitive) {
      case Primitive::kFloat:
      case Primitive::kDouble:
        schema = {{"type", {"number", "null"}}};
        break;
      case Primitive::kBoolean:
        schema = {{"type", "boolean"}};
        break;
      case Primitive::kString:
        schema = {{"type", "string"}};
        break;
      default:
        schema = {{"type", "integer"}};
    }
  }
  std::size_t lists = member.dimensions.size();
  if (lists > 0 && member.primitive == Primitive::kByte) {
    schema = {{"type", "string"}, {"contentEncoding", "base64"}};
    --lists;
  }
  for (; lists > 0; --lists) {
    schema = Json{{"type", "array"}, {"items", schema}};
  }
  if (!member.comment.empty()) {
    schema["description"] = member.comment;
  }
  return schema;
}

Json schemaOf(const MessageType& type, int depth) {
  constexpr int kDeepest = 8;  // a type may hold itself
  Json schema{{"type", "object"}};
  if (depth == 0) {
    schema["title"] = type.package.empty() ? type.name : type.package + "." + type.name;
  }
  if (!type.comment.empty()) {
    schema["description"] = type.comment;
  }
  if (depth > kDeepest) {
    return schema;
  }
  Json& properties = schema["properties"] = Json::object();
  for (const Member& member : type.members) {
    properties[member.name] = schemaOf(member, depth);
  }
  return schema;
}

}  // namespace

std::string jsonString(std::string_view text) {
  return Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
}

const char* appendJson(const MessageType& type, std::span<const std::byte> payload,
                       std::string& text) {
  const std::size_t before = text.size();
  JsonWriter writer(text);
  if (const char* problem = walk(type, payload, writer)) {
    text.resize(before);
    return problem;
  }
  text += '}';
  return nullptr;
}

std::string jsonSchema(const MessageType& type) {
  return schemaOf(type, 0).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace roundabout::logs
