#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace roundabout::config {

/// One YAML document with overrides applied, which knows the line of each of its keys. A key's path
/// is written "vehicles[2].start.heading_rad"; the root's is empty.
class Document {
 public:
  /// Throws core::StartupError: not YAML, more than one document, an override without "=" or whose
  /// path cannot exist.
  Document(const std::string& yaml, std::string file, const std::vector<std::string>& overrides);

  const YAML::Node& root() const { return root_; }

  /// True if an override set this key or one that it is part of.
  bool overridden(const std::string& path) const;

  /// Throws core::StartupError that points at the override that set the key, else at the line
  /// where it stands, or where what it belongs to begins.
  [[noreturn]] void fail(const std::string& path, const std::string& expected,
                         const std::string& found) const;
  /// As fail, at a place in the file that the path alone does not tell.
  [[noreturn]] void failAt(const YAML::Mark& mark, const std::string& path,
                           const std::string& expected, const std::string& found) const;

 private:
  struct Override {
    std::string key;                 // as typed
    std::vector<std::string> steps;  // of its path
  };

  void apply(const std::string& text);
  int lineOf(const std::vector<std::string>& steps, bool& complete) const;

  std::string file_;
  YAML::Node original_;
  YAML::Node root_;
  std::vector<Override> overrides_;
};

/// The text of a file. Throws core::StartupError(path, what, ...) if it cannot be read.
std::string textOfFile(const std::string& path, const std::string& what);

/// What stands there, in a few words: "fast" in quotes, "a list of 3", "a map", "nothing".
std::string found(const YAML::Node& node);

}  // namespace roundabout::config
