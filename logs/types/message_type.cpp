#include "logs/types/message_type.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::logs {

namespace {

struct PrimitiveEntry {
  const char* name;
  Primitive primitive;
  std::size_t bytes;
};

constexpr std::array<PrimitiveEntry, 9> kPrimitives{{
    {"int8_t", Primitive::kInt8, 1},
    {"int16_t", Primitive::kInt16, 2},
    {"int32_t", Primitive::kInt32, 4},
    {"int64_t", Primitive::kInt64, 8},
    {"float", Primitive::kFloat, 4},
    {"double", Primitive::kDouble, 8},
    {"byte", Primitive::kByte, 1},
    {"boolean", Primitive::kBoolean, 1},
    {"string", Primitive::kString, 5},
}};

// What comments of members begin with where the member has a unit.
constexpr std::array<std::string_view, 20> kUnits{
    "us", "ms", "s",  "m", "mm", "m/s", "m/s^2", "rad", "rad/s", "deg",
    "Hz", "N",  "kg", "K", "V",  "A",   "%",     "px",  "bytes", "ns"};

std::string unitIn(const std::string& comment) {
  const std::string first = comment.substr(0, comment.find_first_of(" ,;:"));
  const bool known = std::find(kUnits.begin(), kUnits.end(), first) != kUnits.end();
  // "s" begins a comment such as "s from utime"; a bare "m" or "a" may begin any sentence, but
  // not in a comment that a unit does not begin.
  return known ? first : "";
}

bool isWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-' ||
         c == '+';
}

struct Token {
  std::string text;  ///< empty: the end
  int line = 0;
};

/// Words and single signs, with the comments kept aside by line.
class Lexer {
 public:
  explicit Lexer(const std::string& text) : text_(text) {}

  Token next() {
    skipSpace();
    const std::size_t begin = at_;
    if (at_ < text_.size()) {
      do {
        ++at_;
      } while (isWord(text_[begin]) && at_ < text_.size() && isWord(text_[at_]));
    }
    return {text_.substr(begin, at_ - begin), line_};
  }

  /// All of the comment that goes on until the code begins; then it is forgotten.
  std::string takeComment() { return std::exchange(comment_, {}); }

  /// The rest of the line, if it is a comment.
  std::string commentBeside() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) {
      ++at_;
    }
    if (!startsWith("//") && !startsWith("/*")) {
      return "";
    }
    takeComment();
    skipComment();
    return takeComment();
  }

 private:
  bool startsWith(std::string_view sign) const {
    return text_.compare(at_, sign.size(), sign) == 0;
  }

  void skipSpace() {
    while (at_ < text_.size()) {
      if (startsWith("//") || startsWith("/*")) {
        skipComment();
      } else if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
        line_ += text_[at_] == '\n' ? 1 : 0;
        ++at_;
      } else {
        return;
      }
    }
  }

  void skipComment() {
    const bool block = text_[at_ + 1] == '*';
    const std::size_t begin = at_ + 2;
    const std::size_t end = std::min(text_.find(block ? "*/" : "\n", begin), text_.size());
    std::string part = text_.substr(begin, end - begin);
    line_ += static_cast<int>(std::count(part.begin(), part.end(), '\n'));
    const auto blank = [](unsigned char c) { return std::isspace(c) != 0 || c == '/' || c == '*'; };
    part.erase(part.begin(), std::find_if_not(part.begin(), part.end(), blank));
    part.erase(std::find_if_not(part.rbegin(), part.rend(), blank).base(), part.end());
    comment_ += (comment_.empty() ? "" : " ") + part;
    at_ = std::min(end + (block ? 2 : 0), text_.size());
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::string comment_;
};

class Parser {
 public:
  Parser(const std::string& text, const std::string& file) : lexer_(text), file_(file) { step(); }

  std::vector<std::unique_ptr<MessageType>> parse() {
    std::vector<std::unique_ptr<MessageType>> types;
    while (!token_.text.empty()) {
      const std::string word = take("package or struct");
      if (word == "package") {
        package_ = take("a name");
        lexer_.takeComment();
        expect(";");
      } else if (word == "struct") {
        types.push_back(parseStruct());
      } else {
        fail("package or struct", word);
      }
    }
    return types;
  }

 private:
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw core::StartupError(fmt::format("{}:{}", file_, token_.line), "LCM type", expected,
                             found.empty() ? "the end of the file" : found);
  }

  void step() { token_ = lexer_.next(); }

  std::string take(const char* expected) {
    if (token_.text.empty()) {
      fail(expected, "");
    }
    std::string text = token_.text;
    step();
    return text;
  }

  void expect(const char* sign) {
    if (token_.text != sign) {
      fail(sign, token_.text);
    }
    step();
  }

  bool accept(const char* sign) {
    const bool found = token_.text == sign;
    if (found) {
      step();
    }
    return found;
  }

  std::unique_ptr<MessageType> parseStruct() {
    auto type = std::make_unique<MessageType>();
    type->package = package_;
    type->comment = lexer_.takeComment();
    type->name = take("a name");
    expect("{");
    while (!accept("}")) {
      if (token_.text == "const") {
        parseConstants(*type);
      } else {
        parseMembers(*type);
      }
    }
    accept(";");
    return type;
  }

  void parseConstants(MessageType& type) {
    step();
    take("a type");
    do {
      const std::string name = take("a name");
      expect("=");
      type.constants.push_back({name, take("a value")});
    } while (accept(","));
    expect(";");
  }

  void parseMembers(MessageType& type) {
    const std::size_t first = type.members.size();
    const std::string of = take("a type");
    do {
      Member& member = type.members.emplace_back();
      member.type = of;
      member.primitive = primitiveCalled(of);
      member.name = take("a name");
      while (accept("[")) {
        member.dimensions.push_back(dimension());
        expect("]");
      }
    } while (accept(","));
    if (token_.text != ";") {
      fail(";", token_.text);
    }
    const std::string comment = lexer_.commentBeside();
    step();
    for (std::size_t i = first; i < type.members.size(); ++i) {
      type.members[i].comment = comment;
      type.members[i].unit = unitIn(comment);
    }
  }

  Dimension dimension() {
    Dimension dimension{take("a size"), std::nullopt};
    const std::string& size = dimension.size;
    if (std::all_of(size.begin(), size.end(),
                    [](unsigned char c) { return std::isdigit(c) != 0; })) {
      if (size.size() > 9) {
        fail("a size below 10^9", size);
      }
      dimension.constant = std::stoul(size);
    }
    return dimension;
  }

  Lexer lexer_;
  std::string file_;
  std::string package_;
  Token token_;
};

}  // namespace

std::optional<Primitive> primitiveCalled(const std::string& name) {
  for (const PrimitiveEntry& entry : kPrimitives) {
    if (name == entry.name) {
      return entry.primitive;
    }
  }
  return std::nullopt;
}

const char* nameOf(Primitive primitive) {
  return kPrimitives[static_cast<std::size_t>(primitive)].name;
}

std::size_t bytesOf(Primitive primitive) {
  return kPrimitives[static_cast<std::size_t>(primitive)].bytes;
}

std::vector<std::unique_ptr<MessageType>> parseTypes(const std::string& text,
                                                     const std::string& file) {
  return Parser(text, file).parse();
}

}  // namespace roundabout::logs
