#include "common/config/document.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <optional>
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

// `where` says where a line of the text is.
YAML::Node parse(const std::string& yaml, const std::function<std::string(int line)>& where) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(yaml);
    if (documents.size() > 1) {
      throw core::StartupError(where(documents[1].Mark().line + 1), "file", "one YAML document",
                               fmt::format("{}", documents.size()));
    }
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& error) {
    throw core::StartupError(where(error.mark.line + 1), "file", "YAML",
                             "a syntax error (" + error.msg + ")");
  }
}

std::function<std::string(int)> linesOf(const std::string& file) {
  return [&file](int line) { return fmt::format("{}:{}", file, line); };
}

}  // namespace

std::string found(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) {
    return "nothing";
  }
  if (node.IsScalar()) {
    return quoted(node.Scalar());
  }
  return node.IsSequence() ? fmt::format("a list of {}", node.size()) : "a map";
}

Document::Document(const std::string& yaml, std::string file,
                   const std::vector<std::string>& overrides)
    : file_(std::move(file)),
      original_(parse(yaml, linesOf(file_))),
      root_(parse(yaml, linesOf(file_))) {
  if (!root_.IsMap()) {
    throw core::StartupError(file_, "file", "a map of keys", found(root_));
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
    throw core::StartupError("--set", "argument", "KEY=VALUE", quoted(text));
  }
  const std::string value_text = text.substr(equals + 1);
  YAML::Node value =
      value_text.empty() ? YAML::Node("") : parse(value_text, [&](int) { return where; });

  YAML::Node node = root_;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    YAML::Node child;
    if (node.IsSequence()) {
      const std::optional<std::size_t> index = indexOf(steps[i]);
      if (!index || *index >= node.size()) {
        throw core::StartupError(where, "index",
                                 fmt::format("a number below {} (it is a list)", node.size()),
                                 quoted(steps[i]));
      }
      child.reset(node[*index]);
    } else if (node.IsMap() || node.IsNull()) {
      child.reset(node[steps[i]]);
    } else {
      throw core::StartupError(where, "key", "a path through maps and lists",
                               fmt::format("{} below the value {}", quoted(steps[i]), found(node)));
    }
    if (i + 1 == steps.size()) {
      child = value;
    } else if (!child.IsDefined() || child.IsNull()) {
      child = YAML::Node(YAML::NodeType::Map);
    }
    node.reset(child);
  }
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
