#include "common/config/document.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/config/words.h"
#include "common/core/error.h"

namespace roundabout::config {

namespace {

// Both "vehicles[0].name" and "vehicles.0.name".
std::vector<std::string> stepsOf(const std::string& path) {
  std::vector<std::string> steps;
  std::size_t begin = 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find_first_of(".[]", begin), path.size());
    if (end > begin) {
      steps.push_back(path.substr(begin, end - begin));
    }
    begin = end + 1;
  }
  return steps;
}

std::optional<std::size_t> indexOf(const std::string& step) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  if (error != std::errc() || end != step.data() + step.size()) {
    return std::nullopt;
  }
  return index;
}

bool beginsWith(const std::vector<std::string>& whole, const std::vector<std::string>& begin) {
  return whole.size() >= begin.size() && std::equal(begin.begin(), begin.end(), whole.begin());
}

// `where` says where a line of the text is, `what` what the text is.
YAML::Node parse(const std::string& yaml, const char* what,
                 const std::function<std::string(int line)>& where) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(yaml);
    if (documents.size() > 1) {
      throw core::StartupError(where(documents[1].Mark().line + 1), what, "one YAML document",
                               fmt::format("{}", documents.size()));
    }
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& error) {
    throw core::StartupError(where(error.mark.line + 1), what, "YAML",
                             "a syntax error (" + error.msg + ")");
  }
}

// A copy of `node` in which what the steps lead to is `value`. It shares what lies off that path:
// an alias elsewhere keeps its old value.
YAML::Node with(const YAML::Node& node, std::span<const std::string> steps, const YAML::Node& value,
                const std::string& where) {
  if (steps.empty()) {
    return value;
  }
  const std::string& step = steps.front();
  if (node.IsScalar()) {
    throw core::StartupError(where, "key", "a path through maps and lists",
                             fmt::format("{} below the value {}", inQuotes(step), found(node)));
  }
  if (node.IsSequence()) {
    const std::optional<std::size_t> index = indexOf(step);
    if (!index || *index >= node.size()) {
      throw core::StartupError(where, "index",
                               fmt::format("a number below {} (it is a list)", node.size()),
                               inQuotes(step));
    }
    YAML::Node copy(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < node.size(); ++i) {
      copy.push_back(i == *index ? with(node[i], steps.subspan(1), value, where) : node[i]);
    }
    return copy;
  }
  YAML::Node copy(YAML::NodeType::Map);
  bool replaced = false;
  for (const auto& entry : node) {
    const bool here = !replaced && entry.first.IsScalar() && entry.first.Scalar() == step;
    copy.force_insert(entry.first, here ? with(entry.second, steps.subspan(1), value, where)
                                        : YAML::Node(entry.second));
    replaced = replaced || here;
  }
  if (!replaced) {
    copy.force_insert(step, with(YAML::Node(), steps.subspan(1), value, where));
  }
  return copy;
}

}  // namespace

std::string textOfFile(const std::string& path, const std::string& what) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw core::StartupError(path, what, "a file that can be read",
                             file ? "a folder" : std::strerror(errno));
  }
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string found(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) {
    return "nothing";
  }
  if (node.IsScalar()) {
    return inQuotes(node.Scalar());
  }
  return node.IsSequence() ? fmt::format("a list of {}", node.size()) : "a map";
}

Document::Document(const std::string& yaml, std::string file,
                   const std::vector<std::string>& overrides)
    : file_(std::move(file)),
      original_(
          parse(yaml, "file", [this](int line) { return fmt::format("{}:{}", file_, line); })),
      root_(original_) {
  if (!root_.IsMap()) {
    throw core::StartupError(file_ + ":1", "file", "a map of keys", found(root_));
  }
  for (const std::string& text : overrides) {
    apply(text);
  }
}

void Document::apply(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string key = text.substr(0, equals);
  const std::vector<std::string> steps = stepsOf(key);
  const std::string where = "--set " + key;
  if (equals == std::string::npos || steps.empty()) {
    throw core::StartupError("--set", "argument", "KEY=VALUE", inQuotes(text));
  }
  const std::string value_text = text.substr(equals + 1);
  const YAML::Node value = value_text.empty()
                               ? YAML::Node("")
                               : parse(value_text, "value", [&where](int) { return where; });
  root_.reset(with(root_, steps, value, where));
  overrides_.push_back({key, steps});
}

int Document::lineOf(const std::vector<std::string>& steps, bool& complete) const {
  YAML::Node node = original_;
  int line = node.Mark().line;
  complete = true;
  for (const std::string& step : steps) {
    bool descended = false;
    if (node.IsMap()) {
      for (const auto& entry : node) {
        if (entry.first.IsScalar() && entry.first.Scalar() == step) {
          line = entry.first.Mark().line;
          node.reset(entry.second);
          descended = true;
          break;
        }
      }
    } else if (node.IsSequence()) {
      const std::optional<std::size_t> index = indexOf(step);
      if (index && *index < node.size()) {
        node.reset(node[*index]);
        line = node.Mark().line;
        descended = true;
      }
    }
    if (!descended) {
      complete = false;
      break;
    }
  }
  return line + 1;
}

bool Document::overridden(const std::string& path) const {
  const std::vector<std::string> steps = stepsOf(path);
  return std::any_of(overrides_.begin(), overrides_.end(),
                     [&](const Override& override_) { return beginsWith(steps, override_.steps); });
}

void Document::fail(const std::string& path, const std::string& expected,
                    const std::string& found_there) const {
  const std::vector<std::string> steps = stepsOf(path);
  bool in_file = false;
  const int line = lineOf(steps, in_file);
  // The last override wins, so it is the one to blame.
  for (auto it = overrides_.rbegin(); it != overrides_.rend(); ++it) {
    if (beginsWith(steps, it->steps) || (!in_file && beginsWith(it->steps, steps))) {
      throw core::StartupError("--set " + it->key, oneLine(path), expected, found_there);
    }
  }
  throw core::StartupError(fmt::format("{}:{}", file_, line), oneLine(path), expected, found_there);
}

void Document::failAt(const YAML::Mark& mark, const std::string& path, const std::string& expected,
                      const std::string& found_there) const {
  if (mark.is_null() || overridden(path)) {
    fail(path, expected, found_there);
  }
  throw core::StartupError(fmt::format("{}:{}", file_, mark.line + 1), oneLine(path), expected,
                           found_there);
}

}  // namespace roundabout::config
